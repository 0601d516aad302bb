"""Jerk-limited motions: times of closed forms, limits, and what is refused."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("ruckig")
from manyhands.planning.online import Follower, jerk_limited

LIMITS: dict[str, Any] = {"velocity": 1.0, "acceleration": 2.0, "jerk": 10.0}


def test_the_time_of_a_long_way_is_that_of_seven_phases() -> None:
    motion = jerk_limited([0.0], [3.0], **LIMITS)
    assert motion.duration == pytest.approx(3.0 / 1.0 + 1.0 / 2.0 + 2.0 / 10.0, rel=1e-12)
    assert len(motion.breaks) == 8


def test_any_state_is_led_to_the_goal_within_limits() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        q, goal, v, goal_v = rng.uniform(-1, 1, (4, 3)) * [[2], [2], [0.9], [0.5]]
        a = rng.uniform(-0.3, 0.3, 3)
        motion = jerk_limited(q, goal, **LIMITS, start_velocity=v, start_acceleration=a, goal_velocity=goal_v)
        ends = motion.sample([0, motion.duration])
        np.testing.assert_allclose(ends.q, [q, goal], atol=1e-8)
        np.testing.assert_allclose(ends.v, [v, goal_v], atol=1e-7)
        np.testing.assert_allclose(ends.a, [a, np.zeros(3)], atol=1e-6)
        found = motion.sample(np.linspace(0, motion.duration, 2000))
        assert np.abs(found.v).max() < 1 + 1e-6 and np.abs(found.a).max() < 2 + 1e-6
        assert np.abs(6 * motion.coefficients[:, 3]).max() < 10 * (1 + 1e-3)
        np.testing.assert_allclose(np.diff(found.q, axis=0), found.v[:-1] * motion.duration / 1999, atol=1e-4)


def test_a_start_beyond_the_limit_is_braked() -> None:
    motion = jerk_limited([0.0, 0.0], [1.0, 0.3], **LIMITS, start_velocity=[3.0, 0.0])
    np.testing.assert_allclose(motion.sample(motion.duration).q, [1.0, 0.3], atol=1e-8)
    assert motion.sample(0.0).v[0] == 3.0


def test_a_way_that_just_reaches_its_limits_is_found() -> None:
    # Ruckig alone finds none to -2.4000000000000004.
    limits: dict[str, Any] = {"velocity": 1.0, "acceleration": 10.0, "jerk": 100.0}
    motion = jerk_limited([-2.2], [-2.2 - 0.2], **limits)
    assert motion.duration == pytest.approx(0.4, rel=1e-6)
    np.testing.assert_allclose(Follower([-2.2], 0.5, **limits).step([-2.2 - 0.2]).q, -2.4, atol=1e-9)


def test_a_goal_that_moves_is_followed() -> None:
    follower = Follower([0.0, 0.0], 0.001, **LIMITS)
    last = np.zeros(2)
    for k in range(4000):
        goal = [1.0, -0.5] if k < 300 else [-0.3, 0.2]
        now = follower.step(goal)
        assert np.abs(now.v).max() < 1 + 1e-9 and np.abs(now.a - last).max() < 10 * 0.001 + 1e-9
        last = now.a
    np.testing.assert_allclose(now.q, [-0.3, 0.2], atol=1e-9)
    np.testing.assert_allclose(now.v, 0, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: jerk_limited([0.0], [1.0], velocity=1, acceleration=1, jerk=0), "jerk is"),
        (lambda: jerk_limited([0.0], [1.0, 2.0], **LIMITS), "goal has shape"),
        (lambda: jerk_limited([np.nan], [1.0], **LIMITS), "start must be finite"),
        (lambda: jerk_limited([], [], **LIMITS), "start has shape"),
        (lambda: jerk_limited([0.0], [0.0], **LIMITS), "nothing to do"),
        (lambda: jerk_limited([0.0], [1.0], **LIMITS, goal_velocity=[2.0]), "goal_velocity of joint 0 is 2"),
        (lambda: jerk_limited([0.0], [1e12], **LIMITS), r"no motion from \[0.0\] .* was found within velocity"),
        (lambda: Follower([0.0], 0.0, **LIMITS), "dt is 0"),
        (lambda: Follower([0.0], 0.01, **LIMITS).step([1.0], [2.0]), "velocity"),
    ],
)
def test_refusals(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
