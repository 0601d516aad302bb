"""Trajectories through waypoints and poses, how fast a path can be followed, plans among obstacles, and grasps.

A trajectory is a value: `duration`, and `sample(t)` at one time or many. Numbers of joints are followed as they are, so
quaternions in q (spherical and floating joints) have no trajectory here; poses have (`cartesian`). Units are SI,
quaternions are xyzw, spatial vectors have the angular part first. Wrong shapes, NaN, times that do not rise and limits
that are not above 0 raise ValueError, which names the array.
"""

from manyhands.planning.constraints import AxisConstraint, PathConstraint, PositionConstraint, upright
from manyhands.planning.grasps import Grasps, ParallelGripper, epsilon_quality, grasps, grasps_in
from manyhands.planning.planner import Encounter, Plan, Planner, PlanStatus, plan
from manyhands.planning.timing import time_optimal
from manyhands.planning.trajectories import (
    CartesianPath,
    CartesianSample,
    CartesianTrajectory,
    Sample,
    Trajectory,
    cartesian,
    cubic,
    joined,
    quintic,
    spline,
    trapezoid,
)

__all__ = [
    "AxisConstraint",
    "CartesianPath",
    "CartesianSample",
    "CartesianTrajectory",
    "Encounter",
    "Grasps",
    "ParallelGripper",
    "PathConstraint",
    "Plan",
    "PlanStatus",
    "Planner",
    "PositionConstraint",
    "Sample",
    "Trajectory",
    "cartesian",
    "cubic",
    "epsilon_quality",
    "grasps",
    "grasps_in",
    "joined",
    "plan",
    "quintic",
    "spline",
    "time_optimal",
    "trapezoid",
    "upright",
]
