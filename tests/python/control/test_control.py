"""Controllers over rows; estimation, responses and refusals."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands as mh
from manyhands import control, dynamics
from manyhands.plots import plot_step_response

RNG = np.random.default_rng(0)


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


def every_controller(model: mh.Model, rows: int | None, kind: type) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    shape = (model.nq,) if rows is None else (rows, model.nq)
    q, v, q_d, v_d, a_d = (rng.normal(size=shape).astype(kind) for _ in range(5))
    position, quaternion = np.array([0.4, 0.1, 0.3], kind), np.array([1, 0, 0, 0], kind)
    state = (model, q, v, q_d, v_d, a_d)
    return {
        "gravity_torque": control.gravity_torque(model, q),
        "pd_gravity": control.pd_gravity(model, q, v, q_d, kp=3, kd=2),
        "pd_feedforward": control.pd_feedforward(*state, kp=3, kd=2),
        "computed_torque": control.computed_torque(*state, kp=3, kd=2, ki=1, integral=q),
        "sliding_mode": control.sliding_mode(*state, slope=2, kd=3, robust=1, boundary=0.1),
        "adaptive": control.Adaptive(model, slope=2, kd=3, rate=0.1, dt=0.01).torque(q, v, q_d, v_d, a_d),
        "impedance": control.impedance(model, "panda_hand", q, v, position, quaternion),
        "operational_space": control.operational_space(model, "panda_hand", q, v, position, quaternion, posture=v),
    }


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_rows_are_single_states(panda: mh.Model, kind: type) -> None:
    many = every_controller(panda, 5, kind)
    for name, tau in many.items():
        assert tau.shape == (5, panda.nv) and tau.dtype == kind, name
    for name, tau in every_controller(panda, None, kind).items():
        assert tau.shape == (panda.nv,) and tau.dtype == kind, name


def test_gravity_torque_is_inverse_dynamics_at_rest(panda: mh.Model) -> None:
    q, rest = RNG.normal(size=(7, panda.nq)), np.zeros((7, panda.nv))
    np.testing.assert_array_equal(control.gravity_torque(panda, q), dynamics.rnea(panda, q, rest, rest))


def test_adaptive_goes_on_from_what_it_learned(panda: mh.Model) -> None:
    learner = control.Adaptive(panda, slope=2, kd=3, rate=0.1, dt=0.01)
    begin = learner.inertia
    q, v, zero = RNG.normal(size=panda.nq), RNG.normal(size=panda.nv), np.zeros(panda.nv)
    learner.torque(q, v, zero, zero, zero)
    once = learner.inertia
    learner.torque(q, v, zero, zero, zero)
    assert not np.array_equal(begin, once)
    np.testing.assert_allclose(learner.inertia - once, once - begin, atol=1e-12)
    learner.reset()
    np.testing.assert_array_equal(learner.inertia, begin)


def test_pid_takes_any_shape() -> None:
    pid = control.Pid(2.0, [1.0, 2.0], 0.5, dt=0.1, max_force=100)
    force = pid.force([[1, 1], [2, 2], [3, 3]], 1.0)
    assert force.shape == (3, 2)
    np.testing.assert_allclose(force[0], [2 + 0.1 + 0.5, 2 + 0.2 + 0.5])
    np.testing.assert_allclose(pid.force([[1, 1], [2, 2], [3, 3]], 1.0)[2], [6 + 0.6 + 0.5, 6 + 1.2 + 0.5])
    pid.reset()
    np.testing.assert_allclose(pid.force([1.0, 1.0]), [2.1, 2.2])


def test_limits() -> None:
    np.testing.assert_array_equal(control.limited([5.0, -5.0, 1.0], [2, 3, 4]), [2, -3, 1])
    np.testing.assert_allclose(control.rate_limited([5.0, -5.0], [0, 0], 10, 0.1), [1, -1])


def test_a_kalman_filter_sees_velocities() -> None:
    h, rng = 1e-3, np.random.default_rng(3)
    t = np.arange(3000) * h
    q, v, a = np.sin(2 * t), 2 * np.cos(2 * t), -4 * np.sin(2 * t)
    seen = q + 1e-3 * rng.normal(size=t.size)
    estimate = control.KalmanFilter.of_joints(seen[:1], dt=h, acceleration_noise=0.1, position_noise=1e-3)
    errors = []
    for k in range(1, t.size):
        estimate.predict(np.array([h * h / 2, h]) * a[k - 1])
        errors.append(estimate.update([seen[k]]) - [q[k], v[k]])
    late = np.abs(errors[1000:])
    differences = np.abs(np.diff(seen)[1000:] / h - v[1001:])
    assert late[:, 0].mean() < 2e-4 and late[:, 1].mean() < 0.02
    assert late[:, 1].mean() < differences.mean() / 50
    assert np.all(np.linalg.eigvalsh(estimate.P) > 0)


def test_a_kalman_filter_takes_rows() -> None:
    F, H = np.array([[1, 0.1], [0, 1]]), np.array([[1.0, 0.0]])
    both = control.KalmanFilter(F, H, 0.1 * np.eye(2), [[0.5]], x=np.zeros((2, 2)))
    one = control.KalmanFilter(F, H, 0.1 * np.eye(2), [[0.5]], x=np.zeros(2))
    for z in (1.0, 2.0, 3.0):
        both.predict()
        one.predict()
        both.update([[z], [-z]])
        one.update([z])
    np.testing.assert_allclose(both.x, [one.x, -one.x])
    np.testing.assert_allclose(both.P, [one.P, one.P])


def test_ziegler_nichols() -> None:
    assert control.ziegler_nichols(10, 2) == (6, 6, 1.5)
    assert control.ziegler_nichols(10, 2, "P") == (5, 0, 0)
    assert control.ziegler_nichols(10, 2, "PI") == pytest.approx((4.5, 2.7, 0))
    margins = control.stability_margins([1], [1, 3, 2, 0])
    assert margins.gain == pytest.approx(6) and 2 * math.pi / margins.gain_frequency == pytest.approx(4.442883)


def test_margins_say_whether_the_closed_loop_is_stable() -> None:
    unstable = control.stability_margins([0.5], [1, -1])  # closes to a pole at 0.5
    assert not unstable.stable and unstable.gain == pytest.approx(2)
    stable = control.stability_margins([2], [1, -1])  # at -1
    assert stable.stable and stable.lower_gain == pytest.approx(0.5) and stable.gain == math.inf
    assert not control.stability_margins([1], [1, -1]).stable
    third = control.stability_margins([10], [1, 3, 2, 0])
    w = third.phase_frequency
    assert not third.stable and third.gain == pytest.approx(0.6)
    assert third.phase == pytest.approx(math.pi / 2 - math.atan(w) - math.atan(w / 2))


def test_step_responses_are_drawn(tmp_path: Path) -> None:
    t = np.linspace(0, 5, 500)
    both = {"slow": 1 - np.exp(-t), "fast": 1 - np.exp(-5 * t) * np.cos(8 * t)}
    for name in ("steps.png", "steps.html"):
        assert plot_step_response(t, both, 1.0, tmp_path / name).stat().st_size > 10_000
    with pytest.raises(ValueError, match="no responses"):
        plot_step_response(t, {}, 1.0, tmp_path / "none.png")
    found = control.step_response(t, both["slow"], 1.0)
    assert found.rise_time == pytest.approx(math.log(9), abs=0.02) and found.overshoot == 0


def test_nonsense_is_refused(panda: mh.Model) -> None:
    q = np.zeros(panda.nq)
    with pytest.raises(ValueError, match=r"kp has shape \(3,\)"):
        control.pd_gravity(panda, q, q, q, kp=[1, 2, 3], kd=1)
    with pytest.raises(ValueError, match="v has shape"):
        control.pd_gravity(panda, q, q[:3], q, q, kp=1, kd=1)
    with pytest.raises(KeyError):
        control.impedance(panda, "no such link", q, q, [0, 0, 0], [0, 0, 0, 1])
    with pytest.raises(ValueError, match="'push'"):
        control.operational_space(panda, "panda_hand", q, q, [0, 0, 0], [0, 0, 0, 1], directions=["push"] * 6)  # type: ignore[list-item]
    with pytest.raises(ValueError, match="boundary"):
        control.sliding_mode(panda, q, q, q, q, q, slope=1, kd=1, robust=1, boundary=0)
    with pytest.raises(ValueError, match="dt"):
        control.Pid(1, dt=0)
    with pytest.raises(ValueError, match="covariance"):
        control.KalmanFilter(np.eye(2), np.eye(2), -np.eye(2), np.eye(2), x=np.zeros(2))
    with pytest.raises(ValueError, match="period"):
        control.ziegler_nichols(1, 0)
    with pytest.raises(ValueError, match="rise"):
        control.step_response([1, 0], [0, 0], 1)


STATE = ("q", "v", "q_desired", "v_desired", "a_desired")
POSED = ("q", "v", "position", "quaternion")
NUMBERS: dict[str, tuple[Callable[..., Any], tuple[str, ...], tuple[str, ...]]] = {
    "gravity_torque": (control.gravity_torque, ("q",), ()),
    "pd_gravity": (control.pd_gravity, STATE[:4], ("kp", "kd")),
    "pd_feedforward": (control.pd_feedforward, STATE, ("kp", "kd")),
    "computed_torque": (control.computed_torque, (*STATE, "integral"), ("kp", "kd", "ki")),
    "sliding_mode": (control.sliding_mode, STATE, ("slope", "kd", "robust", "boundary")),
    "impedance": (control.impedance, POSED, ("stiffness", "damping", "rotational_stiffness", "rotational_damping")),
    "operational_space": (
        control.operational_space,
        (*POSED, "velocity", "acceleration", "force", "posture"),
        ("kp", "kd", "rotational_kp", "rotational_kd", "force_damping", "regularisation"),
    ),
}
"""Controllers of a model, and the names of their arrays and of their gains."""


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("name", NUMBERS)
def test_the_input_that_is_nan_is_named(panda: mh.Model, name: str, kind: type) -> None:
    controller, arrays, gains = NUMBERS[name]
    framed = ("panda_hand",) if "position" in arrays else ()
    widths = {"position": 3, "quaternion": 4, "velocity": 6, "acceleration": 6, "force": 6}
    good: dict[str, Any] = {array: np.ones((3, widths.get(array, panda.nv)), kind) for array in arrays}
    good |= dict.fromkeys(gains, 1.0)
    assert np.isfinite(controller(panda, *framed, **good)).all()
    for array in arrays:
        bad = good[array].copy()
        bad[1, 2] = np.nan
        with pytest.raises(ValueError, match=rf"^{array} is -?nan at index 2, row 1"):
            controller(panda, *framed, **(good | {array: bad}))
    for gain in gains:
        with pytest.raises(ValueError, match=rf"^{gain} is -?nan"):
            controller(panda, *framed, **(good | {gain: np.nan}))


def test_gains_and_noises_below_0_are_refused(panda: mh.Model) -> None:
    q = np.zeros(panda.nq)
    calls: dict[str, Callable[[], Any]] = {
        "kp is -1": lambda: control.pd_gravity(panda, q, q, q, kp=-1, kd=1),
        "ki is -1": lambda: control.Pid(1, ki=-1, dt=0.1),
        "damping is -1": lambda: control.impedance(panda, "panda_hand", q, q, [0, 0, 0], [0, 0, 0, 1], damping=-1),
        "rate is": lambda: control.Adaptive(panda, slope=1, kd=1, rate=-1, dt=0.1),
        "acceleration_noise is -1": lambda: control.KalmanFilter.of_joints(
            [0], dt=0.1, acceleration_noise=-1, position_noise=1
        ),
        "position_noise is -1": lambda: control.KalmanFilter.of_joints(
            [0], dt=0.1, acceleration_noise=1, position_noise=-1
        ),
        "ultimate_gain is 0": lambda: control.ziegler_nichols(0, 1),
    }
    for message, call in calls.items():
        with pytest.raises(ValueError, match=message):
            call()


def test_nan_in_laws_without_a_model_is_named() -> None:
    nan = [0.0, np.nan]
    with pytest.raises(ValueError, match="kd"):
        control.Pid(1, kd=nan, dt=0.1)
    with pytest.raises(ValueError, match="max_force"):
        control.Pid(1, dt=0.1, max_force=np.nan)
    with pytest.raises(ValueError, match="rate"):
        control.Pid(1, dt=0.1).force([1, 1], nan)
    with pytest.raises(ValueError, match="force"):
        control.limited(nan, 1)
    with pytest.raises(ValueError, match="most"):
        control.limited([0, 1], nan)
    with pytest.raises(ValueError, match="last"):
        control.rate_limited([0, 1], nan, 1, 0.1)
    with pytest.raises(ValueError, match="position_noise"):
        control.KalmanFilter.of_joints([0, 0], dt=0.1, acceleration_noise=1, position_noise=nan)
    with pytest.raises(ValueError, match="z must be finite"):
        control.KalmanFilter.of_joints([0, 0], dt=0.1, acceleration_noise=1, position_noise=1).update(nan)
    with pytest.raises(ValueError, match="set_point"):
        control.step_response([0, 1], [0, 1], np.nan)
    with pytest.raises(ValueError, match="delay"):
        control.stability_margins([1], [1, 1], delay=np.nan)


def test_a_quaternion_without_a_direction_is_refused(panda: mh.Model) -> None:
    q = np.zeros(panda.nq)
    with pytest.raises(ValueError, match="direction"):
        control.impedance(panda, "panda_hand", q, q, [0, 0, 0], [0, 0, 0, 0])


def test_a_ball_joint_is_refused() -> None:
    builder = mh.ModelBuilder("ball")
    builder.add_link("bob", mass=1, inertia=np.eye(3))
    builder.add_joint("socket", "spherical", "world", "bob")
    with pytest.raises(Exception, match="socket"):
        control.gravity_torque(builder.build(), [0, 0, 0, 1])
