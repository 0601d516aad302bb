"""Motions planned while a robot moves: no jump, within limits, free, and what is said if there is none."""

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("ruckig")
import manyhands as mh
from manyhands import planning
from manyhands.planning.online import stop
from manyhands.planning.replanning import Replan, replan

Array = NDArray[np.float64]
EXAMPLE = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "replanning.py"))
ACCELERATION, JERK = 5.0, 100.0
LIMITS: dict[str, Any] = {"acceleration": ACCELERATION, "jerk": JERK}
LONG = 5.0  # [s] a time limit that no machine is too busy for; the old motion goes on meanwhile
HOLD = 10.0  # [s]


@pytest.fixture(scope="module")
def planner() -> planning.Planner:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.add_plane("floor")
    return planning.Planner(world, EXAMPLE["HAND"])


@pytest.fixture(scope="module")
def slow(planner: planning.Planner) -> planning.Trajectory:
    """To the goal so slowly that a long time limit passes on the way."""
    plan = planner.plan(EXAMPLE["GOAL"], start=EXAMPLE["START"])
    return plan.trajectory(velocity=0.1, acceleration=ACCELERATION)


def assert_goes_on(found: Replan, old: planning.Trajectory, now: float, planner: planning.Planner) -> None:
    """From the old motion's state, without jumps, within limits."""
    t = np.linspace(0, found.motion.duration, 20001)
    q, v, a = found.motion.sample(t)
    for mine, theirs in zip(found.motion.sample(0.5 * found.switch), old.sample(now + 0.5 * found.switch), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-9)
    dt = t[1]
    np.testing.assert_allclose(np.diff(q, axis=0), (v[:-1] + v[1:]) / 2 * dt, atol=ACCELERATION * dt**2)
    assert np.abs(np.diff(v, axis=0)).max() < ACCELERATION * dt * (1 + 1e-3)
    assert np.abs(a).max() < ACCELERATION * (1 + 1e-6)
    assert (np.abs(v) < planner.velocity * (1 + 1e-6)).all()
    link = (t >= found.switch) & (t < min(found.join, found.motion.duration))
    assert np.abs(np.diff(a[link], axis=0)).max() < JERK * dt * (1 + 1e-3)  # no jump of acceleration either
    np.testing.assert_allclose(v[-1], 0, atol=1e-9)


def test_an_obstacle_that_comes_into_the_way_is_avoided_without_a_stop(
    planner: planning.Planner, slow: planning.Trajectory
) -> None:
    now = 2.0
    changed = planner.with_cloud(EXAMPLE["points_of_ball"]())
    assert planner.free_until(slow, now) == slow.duration
    blocked = changed.free_until(slow, now)
    assert now + LONG < blocked < slow.duration
    found = replan(changed, slow, now, EXAMPLE["GOAL"], **LIMITS, time_limit=LONG)
    assert found.success, found.message
    assert_goes_on(found, slow, now, planner)
    assert changed.free_until(found.motion) == found.motion.duration
    q = found.motion.sample(np.linspace(0, found.motion.duration, 3000)).q
    assert min(changed.nearest(row).distance for row in q[::10]) > 0 and changed.is_free(q).all()
    np.testing.assert_allclose(q[-1], EXAMPLE["GOAL"], atol=1e-6)
    speed = np.linalg.norm(found.motion.sample(np.linspace(0, found.join, 2000)).v, axis=1)
    assert speed.min() > 0.02


def test_a_new_goal_is_gone_to(planner: planning.Planner, slow: planning.Trajectory) -> None:
    goals = np.array(EXAMPLE["START"]) + np.random.default_rng(1).uniform(-0.5, 0.5, (10, 7))
    for seed, goal in enumerate(goals[planner.is_free(goals)][:4]):
        found = replan(planner, slow, 3.0, goal, **LIMITS, time_limit=LONG, seed=seed)
        assert found.success, found.message
        assert_goes_on(found, slow, 3.0, planner)
        assert planner.free_until(found.motion) == found.motion.duration
        np.testing.assert_allclose(found.motion.sample(found.motion.duration).q, goal, atol=1e-6)


def test_without_a_way_it_comes_to_rest(planner: planning.Planner, slow: planning.Trajectory) -> None:
    colliding = np.array(EXAMPLE["GOAL"])
    colliding[1] = 1.7  # into the floor
    found = replan(planner, slow, 3.0, colliding, **LIMITS, time_limit=LONG)
    assert found.status == "stopping" and "goal collides" in found.message and found.plan is not None
    assert_goes_on(found, slow, 3.0, planner)
    assert found.motion.duration < LONG + 0.5


def test_what_is_too_near_to_plan_for_is_stopped_for(planner: planning.Planner, slow: planning.Trajectory) -> None:
    changed = planner.with_cloud(EXAMPLE["points_of_ball"]())
    blocked = changed.free_until(slow, 2.0)
    found = replan(changed, slow, blocked - 1, EXAMPLE["GOAL"], **LIMITS, time_limit=LONG)
    assert found.status == "stopping" and found.switch == 0 and found.plan is None
    assert changed.free_until(found.motion) == found.motion.duration < 1
    again = replan(changed, found.motion, found.motion.duration, EXAMPLE["GOAL"], **LIMITS, time_limit=HOLD)
    assert again.success and changed.free_until(again.motion) == again.motion.duration
    ahead = replan(changed, slow, blocked + 0.05, EXAMPLE["GOAL"], **LIMITS)
    assert ahead.status == "collision ahead" and not ahead.success


def test_a_motion_that_is_free_to_its_end_is_stayed_on(planner: planning.Planner) -> None:
    """It turns a corner in time, while each way to stop runs on into what stands behind the corner."""
    turn = np.array(EXAMPLE["START"])
    corner = planning.quintic(
        [0, 1, 2], [turn, turn + 0.8 * np.eye(7)[0], turn + 0.8 * np.eye(7)[0] - 0.6 * np.eye(7)[1]]
    )
    limits = {"acceleration": 2.0, "jerk": 100.0}
    now = 0.7
    rest = stop(*corner.sample(now), velocity=planner.velocity, **limits)
    last = planner.configuration(rest.sample(rest.duration).q)
    behind = planner.with_cloud([mh.kinematics.forward(planner.model, last, EXAMPLE["HAND"])[0]], 0.02)
    assert behind.free_until(rest) < rest.duration
    found = replan(behind, corner, now, turn, **limits, time_limit=0.05)
    assert found.status == "old motion" and "free to its end" in found.message and not found.success
    t = np.linspace(0, found.motion.duration, 500)
    np.testing.assert_allclose(found.motion.sample(t).q, corner.sample(now + t).q, atol=1e-9)
    assert found.switch == pytest.approx(found.motion.duration) == pytest.approx(corner.duration - now)
    assert min(behind.nearest(q).distance for q in found.motion.sample(t[::10]).q) > 0
    for goal, message in ((np.full(7, np.nan), "goal must be finite"), (np.zeros(3), "goal has shape"), (None, "goal")):
        with pytest.raises(ValueError, match=message):
            replan(behind, corner, now, goal, **limits, time_limit=0.05)


def test_constraints_are_kept(planner: planning.Planner, slow: planning.Trajectory) -> None:
    keep = planning.upright("panda_hand", (0, 0, -1), 0.2)
    changed = planner.with_cloud(EXAMPLE["points_of_ball"]())
    found = replan(changed, slow, 2.0, EXAMPLE["GOAL"], **LIMITS, keep=keep, time_limit=LONG)
    assert found.success, found.message
    q = found.motion.sample(np.linspace(0, found.motion.duration, 5000)).q
    p, r = mh.kinematics.forward(planner.model, planner.configuration(q), "panda_hand")
    assert np.arccos(np.clip(-mh.kinematics.matrix(p, r)[:, 2, 2], -1, 1)).max() < 0.2


def test_free_until_is_when_distances_vanish(planner: planning.Planner) -> None:
    motion = planning.quintic([0, 1], [EXAMPLE["START"], EXAMPLE["GOAL"]])
    assert planner.free_until(motion) == motion.duration
    changed = planner.with_cloud(EXAMPLE["points_of_ball"]())
    found = changed.free_until(motion)
    assert changed.nearest(motion.sample(found).q).distance > 0
    assert min(changed.nearest(motion.sample(found + dt).q).distance for dt in (0.002, 0.005, 0.01)) < 1e-3
    beyond = planning.quintic([0, 1], [EXAMPLE["START"], [3.2, 0.2, 0, -2.0, 0, 2.2, 0.785]])
    at = beyond.sample(planner.free_until(beyond)).q[0]
    limit = planner.model.joint(planner.joints[0]).upper
    assert limit - 0.03 < at < limit + 1e-6


def test_parts_and_joined_trajectories_are_the_same_motion() -> None:
    motion = planning.quintic([0, 1, 3], np.random.default_rng(3).normal(size=(3, 2)))
    whole = planning.joined([motion.part(-0.5, 0.7), motion.part(0.7, 1.4), motion.part(1.4, 4)])
    assert whole.duration == pytest.approx(4.5)
    t = np.linspace(0, 4.5, 1001)
    for mine, theirs in zip(whole.sample(t), motion.sample(t - 0.5), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e-9)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"time_limit": 0.0}, "time_limit is 0"),
        ({"jerk": 0.0}, "jerk"),
        ({"goal": np.full(7, np.nan)}, "goal must be finite"),
        ({"now": np.nan}, "now is nan"),
        ({"motion": planning.quintic([0, 1], [[0, 0], [1, 1]])}, "2 joints"),
    ],
)
def test_refusals(planner: planning.Planner, slow: planning.Trajectory, options: dict[str, Any], message: str) -> None:
    given = {"motion": slow, "now": 1.0, "goal": EXAMPLE["GOAL"], **LIMITS, **options}
    with pytest.raises(ValueError, match=message):
        replan(planner, given.pop("motion"), given.pop("now"), **given)
