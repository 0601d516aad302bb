"""Time-optimal motions: known times, limits on a grid finer than ours, and refusals."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import planning

Array = NDArray[np.float64]
LINE = planning.spline([0, 1], [[0.0], [2.0]], 1)
WAYPOINTS = np.random.default_rng(3).uniform(-1, 1, (6, 7))
PATH = planning.spline(np.arange(6.0), WAYPOINTS)
TIGHT = 1 + 1e-6


def arm() -> mh.Model:
    """Two links in a vertical plane."""
    builder = mh.ModelBuilder("arm")
    before = "world"
    for k in range(2):
        link = f"link{k}"
        builder.add_link(link, mass=2.0 - k, com=(0.3, 0, 0), inertia=np.diag([0.01, 0.02, 0.02]).tolist())
        builder.add_joint(f"j{k}", "continuous", before, link, position=(0.6 * k, 0, 0), axis=(0, 1, 0), armature=0.05)
        before = link
    return builder.build()


def finely(motion: planning.Trajectory) -> tuple[Array, planning.Sample]:
    """40 samples in each piece, its ends approached from within."""
    f = np.linspace(1e-9, 1 - 1e-9, 40)
    t = (motion.breaks[:-1, None] + f * np.diff(motion.breaks)[:, None]).ravel()
    return t, motion.sample(t)


def test_a_double_integrator_goes_bang_bang() -> None:
    motion = planning.time_optimal(LINE, acceleration=3.0)
    assert motion.duration == pytest.approx(2 * np.sqrt(2.0 / 3.0), rel=1e-9)
    a = finely(motion)[1].a
    np.testing.assert_allclose(np.abs(a), 3.0, rtol=1e-6)
    assert motion.sample(motion.duration).q == pytest.approx(2.0, abs=1e-12)


def test_with_a_speed_limit_it_is_the_trapezoid() -> None:
    motion = planning.time_optimal(LINE, velocity=1.3, acceleration=3.0, intervals=2000)
    # Where the limit is reached lies between grid points: the time is right to a fraction of one interval's.
    assert motion.duration == pytest.approx(planning.trapezoid([[0], [2]], 1.3, 3.0).duration, rel=1e-5)


def test_speeds_at_the_ends() -> None:
    motion = planning.time_optimal(LINE, acceleration=3.0, start_speed=0.5, end_speed=0.25)  # q = 2 s
    v0, v1 = 1.0, 0.5
    top = np.sqrt((2 * 3.0 * 2.0 + v0**2 + v1**2) / 2)
    assert motion.duration == pytest.approx((2 * top - v0 - v1) / 3.0, rel=1e-4)
    np.testing.assert_allclose(motion.sample([0, motion.duration]).v[:, 0], [v0, v1], atol=1e-9)


@pytest.mark.parametrize("intervals", [20, 200])
def test_limits_hold_and_one_of_them_is_reached_all_along(intervals: int) -> None:
    speed, acceleration = np.linspace(0.8, 1.4, 7), np.linspace(2.0, 4.0, 7)
    motion = planning.time_optimal(PATH, velocity=speed, acceleration=acceleration, intervals=intervals)
    _, found = finely(motion)
    used = np.maximum((np.abs(found.v) / speed).max(1), (np.abs(found.a) / acceleration).max(1))
    assert used.max() <= TIGHT
    if intervals == 200:
        assert np.median(used) > 0.99
    # It is the same path: every waypoint is passed, in order.
    nearest = [np.linalg.norm(found.q - q, axis=1) for q in WAYPOINTS]
    assert max(distance.min() for distance in nearest) < 0.02
    assert (np.diff([distance.argmin() for distance in nearest]) > 0).all()


def test_the_path_is_kept_and_its_own_times_do_not_matter() -> None:
    slow = planning.spline(10 * np.arange(6.0), WAYPOINTS)
    one, other = (planning.time_optimal(path, velocity=1.0, acceleration=2.0) for path in (PATH, slow))
    assert one.duration == pytest.approx(other.duration, rel=1e-9)
    t = np.linspace(0, one.duration, 500)
    np.testing.assert_allclose(one.sample(t).q, other.sample(np.minimum(t, other.duration)).q, atol=1e-7)


def test_torques_are_those_of_inverse_dynamics() -> None:
    model, limit = arm(), np.array([26.0, 7.0])
    path = planning.spline([0, 1, 2, 3], [[-0.5, 0.2], [-1.0, 1.2], [-2.0, 0.3], [-2.5, -0.4]])
    motion = planning.time_optimal(path, torque=limit, model=model, intervals=400)
    _, found = finely(motion)
    used = (np.abs(mh.dynamics.rnea(model, found.q, found.v, found.a)) / limit).max(1)
    assert used.max() <= TIGHT and np.median(used) > 0.98
    freer = planning.time_optimal(path, torque=1.2 * limit, model=model, intervals=400)
    assert freer.duration < motion.duration


def test_a_pendulum_swings_as_fast_as_energy_lets_it() -> None:
    """One link of the arm, down from the side: with torque u the speed follows from work."""
    builder = mh.ModelBuilder("pendulum")
    builder.add_link("rod", mass=1.0, com=(0.5, 0, 0), inertia=np.diag([1e-3, 1e-3, 1e-3]).tolist())
    builder.add_joint("hinge", "continuous", "world", "rod", axis=(0, 1, 0))
    model, torque, inertia = builder.build(), 20.0, 0.25 + 1e-3
    motion = planning.time_optimal(
        planning.spline([0, 1], [[0.0], [1.0]], 1), torque=torque, model=model, end_speed=2.0, intervals=1000
    )
    half = motion.sample(np.linspace(0, 0.3 * motion.duration, 50))
    work = torque * half.q[:, 0] + 9.81 * 0.5 * np.sin(half.q[:, 0])  # +q swings down about +y
    np.testing.assert_allclose(0.5 * inertia * half.v[:, 0] ** 2, work, rtol=5e-3, atol=1e-4)


def test_it_stops_at_corners() -> None:
    q = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]]
    motion = planning.time_optimal(planning.spline([0, 1, 2], q, 1), acceleration=2.0)
    assert motion.duration == pytest.approx(2 * np.sqrt(1 / 2.0) + 2 * np.sqrt(2 / 2.0), rel=1e-9)
    assert motion.duration == pytest.approx(planning.trapezoid(q, np.inf, 2.0).duration, rel=1e-9)


def test_paths_that_begin_and_end_at_rest_are_followed_as_others_are() -> None:
    """A cubic from rest to rest is the same line, along which dq/ds is 0 at the ends."""
    for path in (planning.cubic([0, 1], [[0], [2]]), planning.quintic([0, 1], [[0], [2]])):
        motion = planning.time_optimal(path, velocity=1.3, acceleration=3.0, intervals=500)
        assert motion.duration == pytest.approx(planning.trapezoid([[0], [2]], 1.3, 3.0).duration, rel=0.03)
        _, found = finely(motion)
        assert np.abs(found.v).max() <= 1.3 * TIGHT and np.abs(found.a).max() <= 3.0 * TIGHT


STILL = planning.cubic([0, 1], [[1.0], [1.0]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: planning.time_optimal(STILL, velocity=1, acceleration=1), "the path has no length"),
        (lambda: planning.time_optimal(LINE), "nothing limits the motion"),
        (lambda: planning.time_optimal(LINE, velocity=np.inf), "nothing limits the motion"),
        (lambda: planning.time_optimal(LINE, velocity=-1), "velocity limit 0 is -1; expected a number above 0"),
        (lambda: planning.time_optimal(LINE, acceleration=np.nan), "acceleration limit 0 is nan"),
        (lambda: planning.time_optimal(LINE, velocity=[1, 2]), "velocity has shape"),
        (lambda: planning.time_optimal(LINE, torque=1), "torque limits need a model"),
        (lambda: planning.time_optimal(LINE, torque=1, model=arm()), "the path has 1 joints, the model nq = 2"),
        (lambda: planning.time_optimal(LINE, velocity=1, intervals=1), "intervals is 1"),
        (
            lambda: planning.time_optimal(LINE, velocity=1, acceleration=1, start_speed=0.6),
            "start_speed is 0.6; the limits want 0 to 0.5",
        ),
        (
            lambda: planning.time_optimal(LINE, velocity=1, acceleration=1, end_speed=0.6),
            "end_speed is 0.6; the limits allow at most 0.5",
        ),
        (lambda: planning.time_optimal(LINE, velocity=1, acceleration=1, start_speed=np.nan), "start_speed is nan"),
        (lambda: planning.time_optimal(LINE, velocity=1, acceleration=1, end_speed=-1), "end_speed is -1"),
        (
            lambda: planning.time_optimal(
                planning.spline([0, 1], [[0.0, 0.0], [1.0, 0.0]], 1), torque=[1.0, 1.0], model=arm()
            ),
            "the limits leave no",
        ),
    ],
)
def test_refusals(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
