"""manyhands.kinematics: closed forms, shapes and errors. tests/oracles compares it with Pinocchio."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import manyhands as mh
from manyhands import kinematics as kin

HAND = "panda_grasptarget"


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


def planar_arm() -> mh.Model:
    """Two links of 1 m that turn about z."""
    builder = mh.ModelBuilder("arm")
    for i, parent in enumerate(("world", "link0")):
        builder.add_link(f"link{i}", mass=1.0, com=(0.5, 0.0, 0.0))
        builder.add_joint(f"joint{i}", "revolute", parent, f"link{i}", position=(float(i), 0, 0), axis=(0, 0, 1))
    builder.add_frame("tip", "link1", position=(1.0, 0.0, 0.0))
    return builder.build()


def random_q(model: mh.Model, n: int) -> np.ndarray:
    lower = np.array([joint.lower for joint in model.joints if joint.iq >= 0])
    upper = np.array([joint.upper for joint in model.joints if joint.iq >= 0])
    return np.random.default_rng(0).uniform(lower, upper, (n, model.nq))


def test_formulas_of_a_planar_arm() -> None:
    model, q, v = planar_arm(), np.array([0.4, 0.7]), np.array([1.5, -0.5])
    (s1, c1), (s12, c12) = ((np.sin(a), np.cos(a)) for a in (q[0], q.sum()))
    np.testing.assert_allclose(kin.forward(model, q, "tip")[0], [c1 + c12, s1 + s12, 0], atol=1e-15)
    zero, one = np.zeros(2), np.ones(2)
    mixed = [zero, zero, one, [-s1 - s12, -s12], [c1 + c12, c12], zero]
    np.testing.assert_allclose(kin.jacobian(model, q, "tip"), mixed, atol=1e-15)
    # The second joint passes through (c1, s1); from the tip it lies one metre behind.
    np.testing.assert_allclose(
        kin.jacobian(model, q, "tip", "space"), [zero, zero, one, [0, s1], [0, -c1], zero], atol=1e-15
    )
    body = [zero, zero, one, [np.sin(q[1]), 0], [1 + np.cos(q[1]), 1], zero]
    np.testing.assert_allclose(kin.jacobian(model, q, "tip", "body"), body, atol=1e-15)
    rate = v.sum()
    moving = [zero, zero, zero, [-c1 * v[0] - c12 * rate, -c12 * rate], [-s1 * v[0] - s12 * rate, -s12 * rate], zero]
    np.testing.assert_allclose(kin.jacobian_derivative(model, q, v, "tip"), moving, atol=1e-15)
    screws = kin.screw_axes(model, "tip")
    np.testing.assert_allclose(screws.axes.T, [[0, 0, 1, 0, 0, 0], [0, 0, 1, 0, -1, 0]], atol=1e-15)
    np.testing.assert_allclose(screws.position, [2, 0, 0], atol=1e-15)
    found = kin.manipulability(model, q, "tip")
    assert found.lengths[0] * found.lengths[1] == pytest.approx(abs(np.sin(q[1])), rel=1e-14)  # Yoshikawa 1985
    assert kin.is_singular(model, q, "tip")  # it never leaves its plane


def test_the_panda_is_singular_where_it_is_stretched(panda: mh.Model) -> None:
    bent = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8, 0.0, 0.0])
    stretched = np.zeros(9)
    found = kin.is_singular(panda, [bent, stretched], HAND)
    assert found.tolist() == [False, True]
    ellipsoid = kin.manipulability(panda, bent, HAND)
    J = kin.jacobian(panda, bent, HAND)[3:]
    assert ellipsoid.measure == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)), rel=1e-12)
    assert ellipsoid.condition == pytest.approx(np.linalg.cond(J), rel=1e-12)
    assert ellipsoid.isotropy == pytest.approx(1 / np.linalg.cond(J), rel=1e-12)
    np.testing.assert_allclose((ellipsoid.axes * ellipsoid.lengths**2) @ ellipsoid.axes.T, J @ J.T, atol=1e-14)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rows_are_single_states(panda: mh.Model, dtype: type) -> None:
    q = random_q(panda, 21).astype(dtype)
    v = np.random.default_rng(1).normal(size=q.shape).astype(dtype)
    calls: dict[str, Callable[[Any, Any], Any]] = {
        "position": lambda q, _: kin.forward(panda, q, HAND)[0],
        "quaternion": lambda q, _: kin.forward(panda, q, HAND)[1],
        "measure": lambda q, _: kin.manipulability(panda, q, HAND, "all").measure,
        "axes": lambda q, _: kin.manipulability(panda, q, HAND, "angular").axes,
    }
    forms: tuple[kin.Form, ...] = ("mixed", "space", "body")
    for form in forms:
        calls[form] = lambda q, _, form=form: kin.jacobian(panda, q, HAND, form)
        calls[f"d {form}"] = lambda q, v, form=form: kin.jacobian_derivative(panda, q, v, HAND, form)
    for name, call in calls.items():
        batch = call(q, v)
        assert batch.dtype == dtype, name
        for i in range(len(q)):
            np.testing.assert_array_equal(batch[i], call(q[i], v[i]), err_msg=name)


def test_maps_keep_the_dimensions_in_front() -> None:
    twist = np.random.default_rng(0).uniform(-1, 1, (4, 5, 6))
    position, quaternion = kin.exp6(twist)
    assert (position.shape, quaternion.shape) == ((4, 5, 3), (4, 5, 4))
    np.testing.assert_allclose(kin.log6(position, quaternion), twist, atol=1e-14)
    np.testing.assert_allclose(kin.log3(kin.exp3(twist[..., :3])), twist[..., :3], atol=1e-14)
    Ad = kin.adjoint(position, quaternion)
    np.testing.assert_allclose(
        Ad @ kin.adjoint(position, quaternion, inverse=True), np.broadcast_to(np.eye(6), Ad.shape), atol=1e-14
    )
    again, turned = kin.pose(kin.matrix(position, quaternion))
    np.testing.assert_array_equal(again, position)
    np.testing.assert_allclose(np.abs(np.sum(turned * quaternion, -1)), 1, atol=1e-14)
    assert kin.exp6(twist[0, 0])[0].shape == (3,)
    assert kin.ad(twist[:0]).shape == (0, 5, 6, 6)


def test_screws_move_what_the_model_moves(panda: mh.Model) -> None:
    q = random_q(panda, 5)
    screws = kin.screw_axes(panda, HAND, q[0], "body")
    position, quaternion = kin.product_of_exponentials(screws, kin.screw_coordinates(panda, q, q[0]))
    expected = kin.forward(panda, q, HAND)
    np.testing.assert_allclose(kin.matrix(position, quaternion), kin.matrix(*expected), atol=1e-14)
    assert kin.product_of_exponentials(screws, np.zeros(9))[0].shape == (3,)


Q = [0.0] * 9
WRONG: list[tuple[Callable[[mh.Model], object], type[Exception], str]] = [
    (lambda m: kin.forward(m, [0.0] * 7, HAND), ValueError, r"q has shape \(7,\); expected \(9,\) or \(n, 9\)"),
    (lambda m: kin.forward(m, [*Q[1:], np.nan], HAND), ValueError, "q is -?nan at index 8; expected finite"),
    (lambda m: kin.jacobian(m, [Q, [np.inf, *Q[1:]]], HAND), ValueError, "q is inf at index 0, row 1"),
    (lambda m: kin.forward(m, Q, "hand"), KeyError, "'hand'.*panda_hand"),
    (lambda m: kin.jacobian(m, Q, HAND, "world"), ValueError, "form is 'world'; expected 'mixed', 'space' or 'body'"),  # pyright: ignore[reportArgumentType]
    (lambda m: kin.jacobian_derivative(m, Q, Q[1:], HAND), ValueError, r"v has shape \(8,\); expected \(9,\)"),
    (lambda m: kin.jacobian_derivative(m, Q, [np.nan] * 9, HAND), ValueError, "v is -?nan at index 0"),
    (lambda m: kin.manipulability(m, Q, HAND, "both"), ValueError, "part is 'both'; expected 'linear'"),  # pyright: ignore[reportArgumentType]
    (lambda m: kin.is_singular(m, Q, HAND, tolerance=0), ValueError, "tolerance is 0"),
    (lambda m: kin.screw_axes(m, HAND, Q[1:]), ValueError, r"q0 has shape \(8,\)"),
    (lambda m: kin.screw_axes(m, HAND, [Q]), ValueError, r"q0 has shape \(1, 9\); expected \(9,\)"),
    (lambda m: kin.screw_axes(m, HAND, Q, "mixed"), ValueError, "'space' or 'body'"),  # pyright: ignore[reportArgumentType]
    (lambda m: kin.screw_coordinates(m, [np.nan] * 9), ValueError, "q must be finite"),
    (lambda m: kin.product_of_exponentials(kin.screw_axes(m, HAND), [0.0]), ValueError, r"theta has shape \(1,\)"),
    (
        lambda m: kin.product_of_exponentials(kin.screw_axes(m, HAND)._replace(joint=np.arange(3, dtype=np.int32)), Q),
        ValueError,
        r"joint \(3,\); expected",
    ),
    (
        lambda m: kin.product_of_exponentials(kin.screw_axes(m, HAND)._replace(position=np.zeros((2, 3))), Q),
        ValueError,
        "single pose",
    ),
    (lambda _: kin.exp3([0.0, 1.0]), ValueError, r"rotation has shape \(2,\); expected \(3,\) or \(..., 3\)"),
    (lambda _: kin.exp6([0.0] * 5 + [np.nan]), ValueError, "twist must be finite"),
    (lambda _: kin.log3([0.0] * 4), ValueError, "quaternion is shorter than 1e-06"),
    (lambda _: kin.log6([0.0] * 3, [[0.0, 0.0, 0.0, 1.0]]), ValueError, "as many rows"),
    (lambda _: kin.pose(2 * np.eye(4)), ValueError, "no rigid motion"),
    (lambda _: kin.pose(np.diag([1.0, 1.0, -1.0, 1.0])), ValueError, "no rigid motion"),
]


@pytest.mark.parametrize("k", range(len(WRONG)))
def test_what_is_wrong_is_said(panda: mh.Model, k: int) -> None:
    call, error, text = WRONG[k]
    with pytest.raises(error, match=text):
        call(panda)
