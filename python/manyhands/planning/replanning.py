"""Plans for a robot that moves: from a motion in progress to a new goal, or around what has come into its way.

The new motion begins on the old one, whose state it leaves at one time without a jump of position, velocity or
acceleration, and within limits. Needs the extra `online`, Ruckig.

K. Hauser, V. Ng-Thow-Hing, Fast smoothing of manipulator trajectories using optimal bounded-acceleration shortcuts,
ICRA 2010: from a state of one motion as fast as limits let to a state of another.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.arguments import instance, number
from manyhands.planning.constraints import PathConstraint
from manyhands.planning.online import links, stop
from manyhands.planning.planner import Plan, Planner
from manyhands.planning.trajectories import Sample, Trajectory, joined, limit_row, standing

__all__ = ["Replan", "ReplanStatus", "replan"]

Array = NDArray[np.float64]
ReplanStatus: TypeAlias = Literal["solved", "old motion", "stopping", "collision ahead"]

_JOINS = 16  # points of the new motion that are tried
_FOR_SEARCH = 0.5  # of the time limit; then limits of the motion are looked to
_LONGEST = 3600.0  # [s] of a time limit
_FOR_LINKS = 0.8  # of the time limit, until which points to join it are tried


@dataclass(frozen=True)
class Replan:
    """What `replan` found: what to follow from now on."""

    status: ReplanStatus
    """"old motion": it cannot stop in time for a new way, and stays on the old one, free to its end; "stopping": there
    is no new way, or no time for one, and it comes to rest; "collision ahead": that is not free"""
    message: str
    """in a sentence"""
    motion: Trajectory
    """whose time 0 is now"""
    switch: float
    """[s] from now: until then it is the old motion"""
    join: float
    """[s] from now: from then on it follows the new plan's curve; infinite if there is none"""
    plan: Plan | None
    """from where the robot could stop; None if there was no time for one"""
    took: float
    """[s] of computation. More than `switch`, and the robot has passed the point where the motions part."""

    @property
    def success(self) -> bool:
        """Whether the motion reaches the goal."""
        return self.status == "solved"


def replan(
    planner: Planner,
    motion: Trajectory,
    now: float,
    goal: ArrayLike | None = None,
    *,
    acceleration: ArrayLike,
    jerk: ArrayLike,
    velocity: ArrayLike | None = None,
    position: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    keep: PathConstraint | Sequence[PathConstraint] = (),
    time_limit: float = 0.1,
    seed: int = 0,
) -> Replan:
    """A motion to a goal for a robot that is at time `now` [s] of `motion`, in the planner's scene, free all along.

    goal, position, quaternion, keep: as `Planner.plan` has them. velocity, acceleration, jerk: limits (n,) or one for
    all; velocity by default that of the model. time_limit [s]: for planning, while the robot goes on along the old
    motion. Jerk is limited where the robot stops, and between both motions, which are `time_optimal`. Where the old one
    speeds up until it is at a limit of velocity, leaving it may cross that by acceleration^2 / 2 jerk.

    If the old motion, or a stop at the end of that time, is not free, there is no time to plan: it stays on the old
    motion if that is free to its end, and stops at once if it is not. Follow it, and plan again from there. Raises
    ValueError as `Planner.plan` does, and on a motion of other joints.
    """
    began = time.perf_counter()
    instance("planner", planner, Planner)
    instance("motion", motion, Trajectory, hint="as Plan.trajectory makes one")
    now, time_limit = number("now", now), number("time_limit", time_limit, above=0, most=_LONGEST)
    planner._goal_of(goal, position, quaternion)
    n = len(planner.joints)
    limits = {
        "velocity": limit_row("velocity", planner.velocity if velocity is None else velocity, n),
        "acceleration": limit_row("acceleration", acceleration, n),
        "jerk": limit_row("jerk", jerk, n),
    }
    old, state = motion.part(now, now + time_limit), motion.sample(now + time_limit)
    halt = _halt(state, limits)

    def is_free(part: Trajectory) -> bool:
        return planner.free_until(part, keep=keep) == part.duration

    def found(
        status: ReplanStatus, message: str, parts: list[Trajectory], switch: float, join: float = np.inf
    ) -> Replan:
        return Replan(status, message, joined(parts), switch, join, plan, time.perf_counter() - began)

    plan = None
    if not (is_free(old) and is_free(halt)):
        if now < motion.duration and planner.free_until(motion, now, keep=keep) == motion.duration:
            message = "there is no free stop from which to plan; it stays on the old motion, which is free to its end"
            left = motion.duration - now
            return found("old motion", message, [motion.part(now, motion.duration)], left)
        halt = _halt(motion.sample(now), limits)
        if is_free(halt):
            return found("stopping", "the motion is blocked before there is a plan; it stops at once", [halt], 0.0)
        return found("collision ahead", "not even stopping at once is free", [halt], 0.0)
    rest = halt.sample(halt.duration).q
    left = _FOR_SEARCH * time_limit - (time.perf_counter() - began)
    plan = planner.plan(
        goal, position=position, quaternion=quaternion, start=rest, keep=keep, time_limit=max(0.0, left), seed=seed
    )
    if plan.curve is None:  # none, or the goal is where it stops
        status: ReplanStatus = "solved" if plan.success else "stopping"
        return found(status, plan.message, [old, halt], time_limit)
    new = plan.trajectory(velocity=limits["velocity"], acceleration=limits["acceleration"])
    link, at = halt, 0.0
    for duration, time_there, make in _soonest_first(state, new, limits):
        if duration > halt.duration + new.duration or time.perf_counter() - began > _FOR_LINKS * time_limit:
            break
        if is_free(motion_there := make()):
            link, at = motion_there, time_there
            break
    parts = [old, link] if at == new.duration else [old, link, new.part(at, new.duration)]
    return found("solved", plan.message, parts, time_limit, time_limit + link.duration)


def _soonest_first(
    state: Sample, new: Trajectory, limits: dict[str, Array]
) -> list[tuple[float, float, Callable[[], Trajectory]]]:
    """Links to points of the new motion: how long each takes with the rest of it, where it joins, what makes it."""
    times = np.linspace(0, new.duration, _JOINS)
    rows = map(Sample._make, zip(*new.sample(times), strict=True))
    found = [
        (lasts + new.duration - times[k], float(times[k]), make) for lasts, k, make in links(state, rows, **limits)
    ]
    return sorted(found, key=lambda one: one[0])


def _halt(state: Sample, limits: dict[str, Array]) -> Trajectory:
    """To rest from a state; where it is at rest, to stand still for a moment."""
    if not state.v.any() and not state.a.any():
        return standing(state.q)
    return stop(*state, **limits)
