"""Control of joints."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import control as _control
from manyhands.arguments import FloatArray, bounded, finite_rows, float_arrays, instance, number, real_array, together

_core: Any = _control  # its rows are unpacked, which overloads do not take

Array = NDArray[np.float64]


def gravity_torque(model: Model, q: ArrayLike) -> FloatArray:
    """tau = g(q): the joint forces (..., nv) [N m or N] that hold the robot at rest at q (..., nq)."""
    (q,) = float_arrays(q=q)
    return _core.gravity_torque(model, q)


def pd_gravity(
    model: Model,
    q: ArrayLike,
    v: ArrayLike,
    q_desired: ArrayLike,
    v_desired: ArrayLike | None = None,
    *,
    kp: ArrayLike,
    kd: ArrayLike,
) -> FloatArray:
    """tau = kp (q_desired - q) + kd (v_desired - v) + g(q), (..., nv): comes to rest at q_desired without a steady
    error (Takegaki, Arimoto, 1981). v_desired is 0 by default."""
    q, v, q_d, v_d = float_arrays(q=q, v=v, q_desired=q_desired, v_desired=_or_zeros(v_desired, v))
    return _core.pd_gravity(model, q, v, q_d, v_d, *gain_rows(model, q, kp=kp, kd=kd))


def pd_feedforward(
    model: Model,
    q: ArrayLike,
    v: ArrayLike,
    q_desired: ArrayLike,
    v_desired: ArrayLike,
    a_desired: ArrayLike,
    *,
    kp: ArrayLike,
    kd: ArrayLike,
) -> FloatArray:
    """tau = M a_desired + C v_desired + g at the desired state, + kp (q_desired - q) + kd (v_desired - v), (...,
    nv)."""
    state = _motion(q, v, q_desired, v_desired, a_desired)
    return _core.pd_feedforward(model, *state, *gain_rows(model, state[0], kp=kp, kd=kd))


def computed_torque(
    model: Model,
    q: ArrayLike,
    v: ArrayLike,
    q_desired: ArrayLike,
    v_desired: ArrayLike,
    a_desired: ArrayLike,
    *,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike = 0.0,
    integral: ArrayLike | None = None,
) -> FloatArray:
    """tau = M(q) (a_desired + kp e + ki integral + kd de/dt) + C(q, v) v + g(q), (..., nv), with e = q_desired - q:
    every joint follows as e'' + kd e' + kp e = 0 does (Luh, Walker, Paul, 1980).

    kp [1/s²] and kd [1/s] are of accelerations; kd = 2 sqrt(kp) does not overshoot. integral: (..., nv) of e over time,
    which the caller advances.
    """
    state = _motion(q, v, q_desired, v_desired, a_desired)
    (summed,) = float_arrays(integral=_or_zeros(integral, state[1]))
    summed = summed.astype(state[0].dtype, copy=False)
    return _core.computed_torque(model, *state, *gain_rows(model, state[0], kp=kp, kd=kd, ki=ki), summed)


def sliding_mode(
    model: Model,
    q: ArrayLike,
    v: ArrayLike,
    q_desired: ArrayLike,
    v_desired: ArrayLike,
    a_desired: ArrayLike,
    *,
    slope: ArrayLike,
    kd: ArrayLike,
    robust: ArrayLike,
    boundary: ArrayLike,
) -> FloatArray:
    """Robust control, (..., nv): with e = q_desired - q and s = de/dt + slope e,
    tau = M a_r + C v_r + g + kd s + robust sat(s / boundary), v_r = v + s (Slotine, Li, 1991, section 7.1).

    slope [1/s]; kd [N m s/rad or N s/m]; robust: the force that the model may be wrong by [N m or N]; boundary: |s|
    below which that force falls in proportion, above 0 [rad/s or m/s]. In the end |e| stays below boundary / slope.
    """
    state = _motion(q, v, q_desired, v_desired, a_desired)
    gains = gain_rows(model, state[0], slope=slope, kd=kd, robust=robust, boundary=boundary)
    return _core.sliding_mode(model, *state, *gains)


class Adaptive:
    """Adaptive control (Slotine, Li, 1987): as `sliding_mode` without its robust part, with inertias of the bodies that
    it corrects on its way. The error vanishes whatever they begin with; they need not become the true ones.

    slope [1/s]; kd [N m s/rad or N s/m]; rate: how fast each of the ten numbers of a body is learned, one for all or
    (10,), in the order of `inertia`; dt: the time between calls of `torque` [s]. inertia: (bodies, 10) to begin with,
    by default the model's: mass [kg], mass times centre of mass (3) [kg m], and Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the
    body's origin [kg m²], in the body's axes.
    """

    def __init__(
        self,
        model: Model,
        *,
        slope: ArrayLike,
        kd: ArrayLike,
        rate: ArrayLike,
        dt: float,
        inertia: ArrayLike | None = None,
    ) -> None:
        known = np.asarray(_core.body_parameters(model)).reshape(-1, 10)
        self.slope, self.kd = bounded("slope", slope, model.nv, least=0), bounded("kd", kd, model.nv, least=0)
        self.model, self.rate, self.dt = model, bounded("rate", rate, 10, least=0), number("dt", dt, above=0)
        self._begin = known if inertia is None else finite_rows("inertia", inertia, *known.shape)
        self.reset()

    def reset(self) -> None:
        """Forgets what it has learned."""
        self.inertia = self._begin

    def torque(
        self, q: ArrayLike, v: ArrayLike, q_desired: ArrayLike, v_desired: ArrayLike, a_desired: ArrayLike
    ) -> FloatArray:
        """The joint forces (..., nv) of now; `inertia` (..., bodies, 10) goes on by dt."""
        state = _motion(q, v, q_desired, v_desired, a_desired)
        kind, rows = state[0].dtype, state[0].shape[:-1]
        bodies = self._begin.shape
        theta = np.array(np.broadcast_to(self.inertia, (*rows, *bodies)), kind, order="C").reshape(*rows, -1)
        gains = gain_rows(self.model, state[0], slope=self.slope, kd=self.kd)
        tau, theta = _core.adaptive(self.model, *state, *gains, self.rate.astype(kind), self.dt, theta)
        self.inertia = theta.reshape(*rows, *bodies)
        return tau


class Pid:
    """kp e + ki (integral of e) + kd de/dt within max_force, for any number of values at once.

    dt: the time between calls of `force` [s]. Against windup the integral stands still while the force is at its limit
    and the error would drive it farther (Åström, Hägglund, 2006, section 3.5), and never leaves max_integral. Gains and
    limits are one number, or as many as there are errors.
    """

    def __init__(
        self,
        kp: ArrayLike,
        ki: ArrayLike = 0.0,
        kd: ArrayLike = 0.0,
        *,
        dt: float,
        max_force: ArrayLike = np.inf,
        max_integral: ArrayLike = np.inf,
    ) -> None:
        self.gains = {name: bounded(name, given, least=0) for name, given in (("kp", kp), ("ki", ki), ("kd", kd))}
        limits = {"max_integral": max_integral, "max_force": max_force}
        self.gains |= {name: bounded(name, given, least=0, infinite=True) for name, given in limits.items()}
        self.dt = number("dt", dt, above=0)
        self.reset()

    def reset(self) -> None:
        """Forgets the integral."""
        self.integral: Array = np.zeros(())

    def force(self, error: ArrayLike, rate: ArrayLike = 0.0) -> Array:
        """The forces (...) of errors (...) that change by `rate` (...). Goes on by dt."""
        e, de = together(error=finite_rows("error", error), rate=finite_rows("rate", rate))
        e, de, integral, *gains = together(error=e, rate=de, integral=self.integral, **self.gains)
        force, integral = _core.pid(self.dt, *map(np.ravel, (e, de, integral)), np.stack([*map(np.ravel, gains)]))
        self.integral = integral.reshape(e.shape)
        return force.reshape(e.shape)


def limited(force: ArrayLike, most: ArrayLike) -> FloatArray:
    """The forces within [-most, most]; most: 0 or more."""
    (forces,) = _finite_arrays(force=force)
    forces, limits = together(force=forces, most=bounded("most", most, least=0, infinite=True))
    return np.clip(forces, -limits, limits).astype(forces.dtype, copy=False)


def rate_limited(force: ArrayLike, last: ArrayLike, most_rate: ArrayLike, dt: float) -> FloatArray:
    """The forces, but no farther from the last ones than most_rate dt: what a drive that has a limited rate [N m/s or
    N/s] makes of them."""
    forces, before = _finite_arrays(force=force, last=last)
    change = bounded("most_rate", most_rate, least=0, infinite=True) * number("dt", dt, above=0)
    forces, before, change = together(force=forces, last=before, most_rate=change)
    return np.clip(forces, before - change, before + change).astype(forces.dtype, copy=False)


def gain_rows(model: Model, like: FloatArray, **gains: ArrayLike) -> list[FloatArray]:
    """Gains as arrays (nv,) of the type of `like`. Raises ValueError on those below 0, which drive away from a goal."""
    nv = instance("model", model, Model).nv
    return [bounded(name, given, nv, least=0).astype(like.dtype, copy=False) for name, given in gains.items()]


def single_gains(**gains: float) -> list[float]:
    """Gains that are one number each, likewise."""
    return [number(name, given, least=0) for name, given in gains.items()]


def _finite_arrays(**inputs: ArrayLike) -> list[FloatArray]:
    for name, values in inputs.items():
        finite_rows(name, values)
    return float_arrays(**inputs)


def _or_zeros(given: ArrayLike | None, like: ArrayLike) -> Any:
    return np.zeros_like(real_array("v", like)) if given is None else given


def _motion(
    q: ArrayLike, v: ArrayLike, q_desired: ArrayLike, v_desired: ArrayLike, a_desired: ArrayLike
) -> list[FloatArray]:
    return float_arrays(q=q, v=v, q_desired=q_desired, v_desired=v_desired, a_desired=a_desired)
