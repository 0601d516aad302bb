"""Trajectories: closed forms, scipy's splines and rotations, finite differences, and refusals."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from manyhands import kinematics as kin
from manyhands import planning

interpolate = pytest.importorskip("scipy.interpolate")
rotation = pytest.importorskip("scipy.spatial.transform")

Array = NDArray[np.float64]
RNG = np.random.default_rng(5)
TIMES = np.array([0.0, 0.4, 1.3, 1.9, 2.2, 3.5, 3.6, 5.0])
WAYPOINTS = RNG.normal(size=(8, 3))


def derivatives_agree(f: Callable[[Array], tuple[Array, ...]], times: Array, tolerance: float) -> None:
    """The second and third of what f gives are derivatives of the one before, by central differences."""
    h = 1e-5
    before, at, after = f(times - h), f(times), f(times + h)
    for k in range(2):
        np.testing.assert_allclose((after[k] - before[k]) / (2 * h), at[k + 1], atol=tolerance)


def test_cubic_and_quintic_are_hermite_polynomials() -> None:
    v, a = RNG.normal(size=(2, 8, 3))
    t = np.linspace(0, 5, 1001)
    cubic = planning.cubic(TIMES, WAYPOINTS, v)
    truth = interpolate.CubicHermiteSpline(TIMES, WAYPOINTS, v)
    np.testing.assert_allclose(cubic.sample(t).q, truth(t), atol=1e-12)
    np.testing.assert_allclose(cubic.sample(t).v, truth(t, 1), atol=1e-11)
    quintic = planning.quintic(TIMES, WAYPOINTS, v, a)
    truth = interpolate.BPoly.from_derivatives(TIMES, np.stack([WAYPOINTS, v, a], axis=1))
    np.testing.assert_allclose(quintic.sample(t).q, truth(t), atol=1e-11)
    np.testing.assert_allclose(quintic.sample(t).a, truth.derivative(2)(t), atol=1e-8)


def test_rest_to_rest_is_the_textbook_polynomial() -> None:
    t = np.linspace(0, 2, 101)
    x = t / 2
    cubic, quintic = planning.cubic([0, 2], [[1], [4]]), planning.quintic([0, 2], [[1], [4]])
    np.testing.assert_allclose(cubic.sample(t).q[:, 0], 1 + 3 * (3 * x**2 - 2 * x**3), atol=1e-14)
    np.testing.assert_allclose(quintic.sample(t).q[:, 0], 1 + 3 * (10 * x**3 - 15 * x**4 + 6 * x**5), atol=1e-14)


@pytest.mark.parametrize(("degree", "fixed"), [(1, 0), (3, 0), (3, 1), (5, 0), (5, 1), (5, 2), (7, 0), (7, 2), (7, 3)])
def test_splines_are_scipys(degree: int, fixed: int) -> None:
    ends = RNG.normal(size=(2, fixed, 3))
    out = (degree - 1) // 2 - fixed  # knots left out at each end
    knots = np.r_[[0.0] * (degree + 1), TIMES[1 + out : -1 - out], [5.0] * (degree + 1)]
    conditions: Any = [[(d + 1, ends[side, d]) for d in range(fixed)] for side in range(2)] if fixed else None
    truth = interpolate.make_interp_spline(TIMES, WAYPOINTS, degree, t=knots, bc_type=conditions)
    if fixed == 0:
        np.testing.assert_array_equal(interpolate.make_interp_spline(TIMES, WAYPOINTS, degree).t, knots)
    found = planning.spline(TIMES, WAYPOINTS, degree, ends)
    t = np.linspace(0, 5, 1001)
    scale = np.abs(truth(t)).max()
    np.testing.assert_allclose(found.sample(t).q, truth(t), atol=1e-10 * scale)
    np.testing.assert_allclose(found.sample(t).v, truth(t, 1), atol=1e-8 * scale)


def test_ends_alone_make_a_smooth_curve() -> None:
    v, a = RNG.normal(size=(2, 2, 3))
    cubic = planning.cubic(TIMES, WAYPOINTS, v)
    np.testing.assert_allclose(
        cubic.sample(TIMES).a,
        interpolate.CubicSpline(TIMES, WAYPOINTS, bc_type=((1, v[0]), (1, v[1])))(TIMES, 2),
        atol=1e-9,
    )
    quintic = planning.quintic(TIMES, WAYPOINTS, v, a)
    np.testing.assert_allclose(quintic.sample([0, 5]).v, v, atol=1e-10)
    np.testing.assert_allclose(quintic.sample([0, 5]).a, a, atol=1e-9)
    rest = planning.quintic(TIMES, WAYPOINTS).sample([0, 5])
    np.testing.assert_allclose([rest.v, rest.a], 0, atol=1e-9)


def test_a_trapezoid_takes_the_time_of_its_formula() -> None:
    speed, acceleration = np.array([1.0, 2.0]), np.array([4.0, 1.0])
    q = np.array([[0, 0], [2.0, 0.5], [2.0, 0.0]])  # the first joint limits by speed, then the second by acceleration
    motion = planning.trapezoid(q, speed, acceleration)
    s_speed = min(1 / 2, 2 / 0.5)  # of the line's length
    s_acceleration = min(4 / 2, 1 / 0.5)
    first = 1 / s_speed + s_speed / s_acceleration
    assert motion.duration == pytest.approx(first + 2 * np.sqrt(0.5 / 1.0), rel=1e-14)
    found = motion.sample(np.linspace(0, motion.duration, 5001))
    assert (np.abs(found.v) <= speed * (1 + 1e-12)).all() and (np.abs(found.a) <= acceleration * (1 + 1e-12)).all()
    np.testing.assert_allclose(found.q[-1], q[-1], atol=1e-14)
    np.testing.assert_allclose(motion.sample(first).q, q[1], atol=1e-14)
    on_line = found.q[np.linspace(0, motion.duration, 5001) < first]
    np.testing.assert_allclose(on_line[:, 1], on_line[:, 0] / 4, atol=1e-14)


def test_derivatives_are_those_of_the_position() -> None:
    t = RNG.uniform(0.01, 4.99, 200)
    t = t[np.abs(t[:, None] - TIMES).min(axis=1) > 1e-3]
    v, a = RNG.normal(size=(2, 8, 3))
    for motion in (
        planning.cubic(TIMES, WAYPOINTS, v),
        planning.quintic(TIMES, WAYPOINTS, v, a),
        planning.spline(TIMES, WAYPOINTS, 7),
    ):
        size = np.abs(np.array(motion.sample(t))).max()
        derivatives_agree(motion.sample, t, 1e-4 * size)


def test_shapes_ends_and_values() -> None:
    motion = planning.spline(TIMES, WAYPOINTS)
    assert motion.sample(1.0).q.shape == (3,) and motion.sample(np.ones((2, 4))).a.shape == (2, 4, 3)
    before, after = motion.sample([-1.0, 9.0]), motion.sample([0.0, motion.duration])
    np.testing.assert_array_equal(before.q, after.q)
    assert not before.v.any() and not before.a.any() and after.v.all()
    copy = pickle.loads(pickle.dumps(motion))
    np.testing.assert_array_equal(copy.sample(TIMES).q, motion.sample(TIMES).q)
    assert repr(copy) == "Trajectory(width=3, duration=5, pieces=5)"


def poses() -> tuple[Array, Array]:
    return RNG.normal(size=(3, 3)), rotation.Rotation.random(3, random_state=1).as_quat()


def test_a_straight_motion_is_a_line_and_slerp() -> None:
    p, r = poses()
    motion = planning.cartesian(p, r, planning.cubic([0, 1, 2], [[0], [1], [2]], np.ones((3, 1))))
    t = np.linspace(0, 2, 201)
    found = motion.sample(t)
    slerp = rotation.Slerp([0, 1, 2], rotation.Rotation.from_quat(r))(t)
    np.testing.assert_allclose((rotation.Rotation.from_quat(found.quaternion) * slerp.inv()).magnitude(), 0, atol=1e-12)
    np.testing.assert_allclose(found.position, np.stack([np.interp(t, [0, 1, 2], x) for x in p.T], 1), atol=1e-13)


def test_a_screw_is_the_exponential_of_its_twist() -> None:
    linalg = pytest.importorskip("scipy.linalg")
    p, r = poses()
    motion = planning.cartesian(p, r, planning.cubic([0, 2], [[0], [2]], np.ones((2, 1))), "screw")
    T = kin.matrix(p, r)
    step = linalg.logm(np.linalg.inv(T[1]) @ T[2]).real
    for s in np.linspace(0, 1, 11):
        found = motion.sample(1 + s)
        np.testing.assert_allclose(
            kin.matrix(found.position, found.quaternion), T[1] @ linalg.expm(s * step), atol=1e-12
        )


@pytest.mark.parametrize("path", ["straight", "screw"])
def test_cartesian_velocities_are_derivatives(path: planning.CartesianPath) -> None:
    motion = planning.cartesian(*poses(), [0, 1.5, 2.5], path)
    assert motion.duration == 2.5
    t, h = np.linspace(0.1, 2.4, 50), 1e-6
    before, at, after = motion.sample(t - h), motion.sample(t), motion.sample(t + h)
    turn = rotation.Rotation.from_quat(after.quaternion) * rotation.Rotation.from_quat(before.quaternion).inv()
    np.testing.assert_allclose(turn.as_rotvec() / (2 * h), at.velocity[:, :3], atol=1e-7)
    np.testing.assert_allclose((after.position - before.position) / (2 * h), at.velocity[:, 3:], atol=1e-7)
    np.testing.assert_allclose((after.velocity - before.velocity) / (2 * h), at.acceleration, atol=1e-6)
    np.testing.assert_allclose(motion.sample([0, 1.5, 2.5]).velocity, 0, atol=1e-12)


UP = [[0.0], [1.0]]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: planning.cubic([0, 1], [[0, 1], [1, np.nan]]), "waypoints must be finite"),
        (lambda: planning.cubic([0, 1, 1], [[0], [1], [2]]), "times must rise, but number 2 is 1 after 1"),
        (lambda: planning.cubic([1, 2], UP), "times begins at 1; expected 0"),
        (lambda: planning.cubic([0, 1, 2], UP), "3 times for 2 waypoints"),
        (lambda: planning.cubic([0, 1], [0, 1]), "waypoints has shape"),
        (lambda: planning.cubic([0, 1], np.zeros((2, 0))), "one column or more"),
        (lambda: planning.cubic([0, 1], UP, [[0, 0], [0, 0]]), "velocity has 4 numbers; expected 2 rows of 1"),
        (lambda: planning.quintic([0, 1, 2], [[0], [1], [2]], np.zeros((3, 1))), "acceleration has 2 numbers"),
        (lambda: planning.cubic([0, 1e-200], UP), "coefficients holds"),
        (lambda: planning.spline(TIMES, WAYPOINTS, 4), "degree is 4; expected 1, 3, 5 or 7"),
        (lambda: planning.spline([0, 1], UP, 3), "needs 4 waypoints, not 2"),
        (lambda: planning.spline([0, 1], UP, 1, np.zeros((2, 1, 1))), "has room for 0"),
        (lambda: planning.spline([0, 1], UP, 3, np.zeros((2, 1, 2))), "ends has shape"),
        (lambda: planning.trapezoid(UP, 0, 1), "velocity limit 0 is 0; expected a number above 0"),
        (lambda: planning.trapezoid(UP, 1, [np.nan]), "acceleration limit 0 is nan"),
        (lambda: planning.trapezoid(UP, [1, 2], 1), "velocity has shape"),
        (lambda: planning.trapezoid([[0], [1], [1]], 1, 1), "between waypoints 1 and 2 nothing moves"),
        (lambda: planning.trapezoid(UP, 1, np.inf), "no joint that moves has an acceleration limit"),
        (lambda: planning.Trajectory([0, 1], np.zeros((2, 1, 1, 1))), "coefficients has shape"),
        (lambda: planning.Trajectory([0, 1, 2], np.zeros((1, 3, 1))), "there are 3 coefficients"),
        (lambda: planning.cubic([0, 1], UP).sample(np.nan), "t must be finite"),
        (lambda: planning.cartesian(np.zeros((2, 3)), np.zeros((2, 4)), [0, 1]), "quaternion is shorter"),
        (lambda: planning.cartesian(np.zeros((2, 3)), np.ones((3, 4)), [0, 1]), "expected \\(m, 3\\) and"),
        (lambda: planning.cartesian(np.zeros((3, 3)), np.ones((3, 4)), planning.cubic([0, 1], UP)), "from 0 to 2"),
        (lambda: planning.cartesian(np.zeros((2, 3)), np.ones((2, 4)), [0, 1], "curve"), "'straight' or 'screw'"),  # type: ignore[arg-type]
    ],
)  # fmt: skip
def test_refusals(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
