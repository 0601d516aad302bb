"""Plans under constraints, measured by forward kinematics at every millimetre of their ways."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import planning

Array = NDArray[np.float64]
HAND = "panda_grasptarget"
HOME = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03])
DOWN = (1.0, 0.0, 0.0, 0.0)
WITHIN = 0.15


def scene() -> mh.World:
    """A Panda that holds a cup, before a post."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = HOME
    position, _ = world.body_pose(HAND)
    world.add_cylinder("post", 0.04, 0.35, position=(0.6, 0, 0.35), fixed=True)
    world.add_cylinder("cup", 0.03, 0.05, position=position)
    return world


@pytest.fixture(scope="module")
def planner() -> planning.Planner:
    return planning.Planner(scene(), HAND, attached={"cup": "panda_hand"})


def ends(planner: planning.Planner) -> tuple[Array, Array]:
    """To both sides of the post, the hand straight down."""
    start, goal = (np.array([turn, 0.2, 0, -2.0, 0, 2.2, 0.785]) for turn in (-0.6, 0.6))
    assert planner.is_free(np.array([start, goal])).all() and not planner.is_way_free(start, goal)
    return start, goal


def every_millimetre(planner: planning.Planner, curve: planning.Trajectory) -> tuple[Array, Array]:
    """Positions and quaternions of the hand along a curve, no more than a millimetre apart."""
    count = 1000
    while True:
        rows = curve.sample(np.linspace(0, curve.duration, count)).q
        p, r = mh.kinematics.forward(planner.model, planner.configuration(rows), HAND)
        if np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 1e-3:
            return np.asarray(p), np.asarray(r)
        count *= 2


def tilt(quaternions: Array) -> Array:
    """The angle between the hand's z and straight down."""
    z = mh.kinematics.matrix(np.zeros((len(quaternions), 3)), quaternions)[:, :3, 2]
    return np.arctan2(np.hypot(z[:, 0], z[:, 1]), -z[:, 2])


def test_a_cup_stays_upright_all_along_the_way(planner: planning.Planner) -> None:
    start, goal = ends(planner)
    for seed in range(3):
        plan = planner.plan(goal, start=start, keep=planning.upright("cup", within=WITHIN), seed=seed, time_limit=10)
        assert plan.success and plan.curve is not None, plan.message
        motion = plan.trajectory(acceleration=5.0)
        for curve in (plan.curve, motion):
            _, quaternions = every_millimetre(planner, curve)
            assert tilt(quaternions).max() < WITHIN
        assert planner.least_distance(plan.waypoints).distance > 0
    free = planner.plan(goal, start=start)
    assert free.curve is not None
    assert tilt(every_millimetre(planner, free.curve)[1]).max() > WITHIN  # so the constraint has something to do


def test_a_hand_stays_within_bounds_of_position(planner: planning.Planner) -> None:
    start, goal = ends(planner)
    p, r = mh.kinematics.forward(planner.model, planner.configuration(start), HAND)
    low, high = np.array([-np.inf, -np.inf, -0.05]), np.array([np.inf, np.inf, 0.35])
    keep = [
        planning.PositionConstraint(HAND, low, high, position=p),
        planning.AxisConstraint(HAND, (0, 0, 1), 0.5, (0, 0, -1)),
    ]
    plan = planner.plan(goal, start=start, keep=keep, time_limit=10)
    assert plan.curve is not None, plan.message
    positions, r = every_millimetre(planner, plan.curve)
    along = positions - p
    assert ((along > low) & (along < high)).all()
    assert tilt(r).max() < 0.5


def test_bounds_lie_along_the_axes_of_their_reference(planner: planning.Planner) -> None:
    eighth = (0.0, 0.0, float(np.sin(np.pi / 8)), float(np.cos(np.pi / 8)))  # x towards (1, 1, 0)
    start = ends(planner)[0]
    goal = start - np.array([0.5, 0, 0, 0, 0, 0, 0])
    p = np.asarray(mh.kinematics.forward(planner.model, planner.configuration(np.array([start, goal])), HAND)[0])
    along = p @ [np.sqrt(0.5), np.sqrt(0.5), 0]
    lower, upper = (along.min() - 0.01, -np.inf, -np.inf), (along.max() + 0.01, np.inf, np.inf)
    keep = planning.PositionConstraint(HAND, lower, upper, quaternion=eighth)
    plan = planner.plan(goal, start=start, keep=keep, time_limit=10)
    assert plan.curve is not None, plan.message
    found = every_millimetre(planner, plan.curve)[0] @ [np.sqrt(0.5), np.sqrt(0.5), 0]
    assert found.min() > lower[0] and found.max() < upper[0]


def test_what_breaks_a_constraint_is_said(planner: planning.Planner) -> None:
    start, goal = ends(planner)
    tipped = goal.copy()
    tipped[5] += 0.5
    keep = planning.upright("cup")
    plan = planner.plan(tipped, start=start, keep=keep)
    assert plan.status == "goal breaks constraint" and "'cup' is 0.5 rad" in plan.message
    plan = planner.plan(goal, start=tipped, keep=keep)
    assert plan.status == "start breaks constraint" and "0.1" in plan.message
    low = planning.PositionConstraint(HAND, (-np.inf, -np.inf, 1), (np.inf, np.inf, 2))
    plan = planner.plan(goal, start=start, keep=[keep, low])
    assert plan.status == "start breaks constraint" and "along (0, 0, 1)" in plan.message


def test_time_limits_are_kept_under_constraints_that_leave_no_way(planner: planning.Planner) -> None:
    start, goal = (end * [0.5, 1, 1, 1, 1, 1, 1] for end in ends(planner))
    p, _ = mh.kinematics.forward(planner.model, planner.configuration(start), HAND)
    low, high = (p[0] - 0.02, -1, p[2] - 0.02), (p[0] + 0.05, 1, p[2] + 0.02)  # no wider than the post
    level = planning.PositionConstraint(HAND, low, high)
    plan = planner.plan(goal, start=start, keep=[level, planning.upright("cup")], time_limit=0.2)
    assert plan.status == "time limit" and plan.search_time < 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: planning.upright("cup", within=0.0), "within is 0 rad"),
        (lambda: planning.upright("cup", axis=(0, 0, 0)), "no direction"),
        (lambda: planning.upright("cup", axis=(0, 0, np.nan)), "axis must be finite"),
        (lambda: planning.upright("cup", axis=((0, 0, 1), (0, 1, 0))), "axis has shape"),
        (lambda: planning.PositionConstraint("cup", (0, 0, 0), (1, 1, 0)), "0.001 m more"),
        (lambda: planning.PositionConstraint("cup", (0, 0), (1, 1)), r"lower has shape \(2,\); expected \(3,\)"),
        (lambda: planning.PositionConstraint("cup", quaternion=(0, 0, 0, 0)), "quaternion"),
    ],
)
def test_constraints_without_sense_are_refused_where_they_are_made(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("keep", "error", "message"),
    [
        (planning.upright("post"), ValueError, "'post', which no planned joint turns"),
        (planning.upright("nobody"), KeyError, "nobody"),
        (["cup"], TypeError, r"keep\[0\] is 'cup'; expected AxisConstraint or PositionConstraint"),
        (None, TypeError, "keep is None; expected a list of AxisConstraint"),
    ],
)
def test_constraints_that_do_not_fit_are_refused(
    planner: planning.Planner, keep: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        planner.plan(planner.start + 0.01, keep=keep)
