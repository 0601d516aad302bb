"""Control of a frame: what it does to joints."""

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import control as _control
from manyhands.arguments import FloatArray, choice, finite_rows, float_arrays, listed, number, together
from manyhands.control.joints import single_gains

_core: Any = _control  # its rows are unpacked, which overloads do not take

Array = NDArray[np.float64]
Direction: TypeAlias = Literal["motion", "force", "free"]


def impedance(
    model: Model,
    frame: str,
    q: ArrayLike,
    v: ArrayLike,
    position: ArrayLike,
    quaternion: ArrayLike,
    *,
    stiffness: float = 1000.0,
    damping: float = 100.0,
    rotational_stiffness: float = 50.0,
    rotational_damping: float = 2.0,
) -> FloatArray:
    """tau = Jᵀ F + C v + g, (..., nv), of a spring and a damper between a frame and its goal at position (..., 3) [m],
    quaternion (..., 4) xyzw (Hogan, 1985). At rest the frame yields by F / stiffness to a force F.

    stiffness [N/m], damping [N s/m], rotational_stiffness [N m/rad], rotational_damping [N m s/rad].
    """
    q, v, p, r = _posed(q, v, position, quaternion)
    spring = single_gains(
        stiffness=stiffness,
        damping=damping,
        rotational_stiffness=rotational_stiffness,
        rotational_damping=rotational_damping,
    )
    return _core.impedance(model, frame, q, v, p, r, *spring)


def operational_space(
    model: Model,
    frame: str,
    q: ArrayLike,
    v: ArrayLike,
    position: ArrayLike,
    quaternion: ArrayLike,
    *,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    force: ArrayLike | None = None,
    posture: ArrayLike | None = None,
    directions: Sequence[Direction] = ("motion",) * 6,
    kp: float = 400.0,
    kd: float = 40.0,
    rotational_kp: float = 400.0,
    rotational_kd: float = 40.0,
    force_damping: float = 10.0,
    regularisation: float = 1e-6,
) -> FloatArray:
    """Joint forces (..., nv) with which a frame moves as a unit mass that is told where to go, and pushes where it is
    told to push (Khatib, 1987). What freedom is left serves a second task.

    position (..., 3), quaternion (..., 4): the goal; velocity, acceleration (..., 6): its own, world axes, 0 by
    default. directions: what becomes of the turns about the goal's x, y, z, and of the shifts along them. "motion"
    follows the goal with kp [1/s²] and kd [1/s], or the rotational ones. "force" pushes with `force` (..., 6), moments
    first [N m, N], in the goal's axes, and damps the velocity there by force_damping [N s/m]. "free" is left to
    `posture` (..., nv), joint forces of a second task that disturb neither of the others. regularisation: of the
    inverse of the frame's inertia, relative to its largest entry; near singular postures a larger one asks for less
    acceleration.
    """
    q, v, p, r = _posed(q, v, position, quaternion)
    kind, rows = q.dtype, q.shape[:-1]
    of_goal = {"velocity": velocity, "acceleration": acceleration, "force": force}
    six = [_six(name, given, kind, rows) for name, given in of_goal.items()]
    second = None if posture is None else float_arrays(posture=posture)[0].astype(kind, order="C", copy=False)
    followed = [choice("directions", way, "motion", "force", "free") for way in listed("directions", directions, str)]
    gains = single_gains(
        kp=kp,
        kd=kd,
        rotational_kp=rotational_kp,
        rotational_kd=rotational_kd,
        force_damping=force_damping,
        regularisation=regularisation,
    )
    return _core.operational_space(model, frame, q, v, p, r, *six, second, followed, *gains)


class Admittance:
    """How a mass on a spring and a damper gives way to a force: what a stiff robot adds to its goal to feel like one.

    mass [kg], damping [N s/m], stiffness [N/m], and inertia [kg m²], rotational_damping [N m s/rad],
    rotational_stiffness [N m/rad] of its turns, which should stay small. Without stiffness it goes on where it is
    pushed. dt: the time between calls of `move` [s]; stable for any, as it is implicit.
    """

    def __init__(
        self,
        *,
        dt: float,
        mass: float = 5.0,
        damping: float = 100.0,
        stiffness: float = 0.0,
        inertia: float = 0.1,
        rotational_damping: float = 2.0,
        rotational_stiffness: float = 0.0,
    ) -> None:
        moved, turned = number("mass", mass, above=0), number("inertia", inertia, above=0)
        d, k = single_gains(damping=damping, stiffness=stiffness)
        spins = single_gains(rotational_damping=rotational_damping, rotational_stiffness=rotational_stiffness)
        self.dt, self._law = number("dt", dt, above=0), np.array([moved, d, k, turned, *spins])
        self.reset()

    def reset(self) -> None:
        """Back to rest where it began."""
        self.displacement: Array = np.zeros(6)
        self.velocity: Array = np.zeros(6)

    def move(self, force: ArrayLike) -> Array:
        """The displacement (..., 6) after dt under a force (..., 6), moments first [N m, N]: a rotation vector and a
        shift, in the axes of the force."""
        F = finite_rows("force", force, 6)
        x, v = (np.broadcast_to(state, F.shape).reshape(-1, 6) for state in (self.displacement, self.velocity))
        x, v = _core.admit(self.dt, F.reshape(-1, 6), x, v, self._law)
        self.displacement, self.velocity = x.reshape(F.shape), v.reshape(F.shape)
        return self.displacement


def _six(name: str, given: ArrayLike | None, kind: Any, rows: tuple[int, ...]) -> FloatArray:
    """A motion or force (..., 6) for every state; 0 by default."""
    (row,) = float_arrays(**{name: np.zeros(6) if given is None else given})
    row, _ = together(**{name: row, "a motion of every state": np.empty((*rows, 6))})
    return np.ascontiguousarray(row, kind)


def _posed(q: ArrayLike, v: ArrayLike, position: ArrayLike, quaternion: ArrayLike) -> list[FloatArray]:
    """A pose without rows goes with every state."""
    q, v, p, r = float_arrays(q=q, v=v, position=position, quaternion=quaternion)
    rows = q.shape[:-1]
    if p.ndim == r.ndim == 1:
        p, r = np.broadcast_to(p, (*rows, *p.shape)), np.broadcast_to(r, (*rows, *r.shape))
    return [q, v, np.asarray(p, order="C"), np.asarray(r, order="C")]
