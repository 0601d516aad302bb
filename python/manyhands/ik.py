"""Inverse kinematics: the joint configuration that brings a frame to a goal."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _core
from manyhands.arguments import all_finite, finite_rows, whole_number
from manyhands.rigid_motions import unit_quaternions

if TYPE_CHECKING:
    from manyhands.planning.planner import Planner

__all__ = ["IkResult", "inverse", "inverse_kinematics"]

Array = NDArray[np.float64]

_SHORTEST = 1e-6  # of directions
_AXIS = (0.0, 0.0, 1.0)


class IkResult(NamedTuple):
    """What `inverse` and `inverse_kinematics` found; for n targets every field has n rows, for a single one none."""

    q: NDArray[np.float64]
    """(..., nq) the configuration: the solution, or the nearest that was found."""
    success: NDArray[np.bool_]
    """Whether both errors are within tolerance, and q is free of collision if that was asked."""
    position_error: NDArray[np.float64]
    """[m], 0 where the goal asks for no position"""
    rotation_error: NDArray[np.float64]
    """[rad], 0 where the goal asks for no orientation"""


def inverse(
    model: Model,
    frame: str,
    *,
    position: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    look_at: ArrayLike | None = None,
    axis: ArrayLike = _AXIS,
    posture: ArrayLike | None = None,
    position_weight: float = 1.0,
    rotation_weight: float = 1.0,
    relative_to: str | None = None,
    avoid: "Planner | None" = None,
    start: ArrayLike | None = None,
    restarts: int = 100,
    seed: int = 0,
    respect_limits: bool = True,
    position_tolerance: float = 1e-5,
    rotation_tolerance: float = 1e-4,
) -> IkResult:
    """Configurations that bring `frame` to a goal: a `position` (3,) [m], one kind of orientation, or both.

    quaternion: (4,) xyzw, the whole orientation.
    direction: (3,), of any length: along it lies the frame's `axis` (3,), the spin about which is free.
    look_at: (3,) [m], a point of the world through which that axis passes, from the frame's origin.
    posture: (nq,) to stay near where the goal leaves room. The first attempt begins there unless `start` is given.
    position_weight, rotation_weight: of a metre and a radian, in what remains of a goal that cannot be reached.
    relative_to: another frame. The goal is then one in its axes and from its origin, and the joints that move only one
    of both frames are solved for: those of two arms.
    avoid: a planner of the same model, which plans all joints that are solved for. Attempts go on until one is free of
    collision in its scene, which is also the default start. If none is, success is False while the errors are within
    tolerance.

    Goals may have n rows, (n, 3) and (n, 4); what has a single one then holds for all. Everything else is as in
    `inverse_kinematics`, which is the goal of position and quaternion.

    Raises KeyError for an unknown frame; ValueError for a wrong shape or number, a goal that asks for nothing or for
    two orientations, a joint of several degrees of freedom between the world and the frame, or a planner that does not
    fit.
    """
    goal = _goal(position, quaternion, direction, look_at)
    preferred = None if posture is None else _configuration(model, "posture", posture)
    if start is not None:
        q0 = _configuration(model, "start", start)
    elif preferred is not None:
        q0 = preferred
    else:
        q0 = model.neutral_configuration() if avoid is None else avoid.configuration(avoid.start)
    for name, number in (
        ("position_tolerance", position_tolerance),
        ("rotation_tolerance", rotation_tolerance),
        ("position_weight", position_weight),
        ("rotation_weight", rotation_weight),
    ):
        if not number > 0:
            raise ValueError(f"{name} is {number}; expected more than 0")
    found: Any = _core.search(
        model,
        frame,
        relative_to or "",
        goal.position,
        goal.quaternion,
        goal.toward,
        q0,
        orientation=goal.orientation,
        axis=_unit("axis", axis).tolist() if goal.orientation in ("along", "at") else _AXIS,
        position_weight=position_weight if goal.places else 0.0,
        rotation_weight=rotation_weight,
        posture=np.zeros(0) if preferred is None else preferred,
        restarts=whole_number("restarts", restarts, 0, 2**31 - 1),
        seed=whole_number("seed", seed, 0, 2**64 - 1),
        respect_limits=respect_limits,
        position_tolerance=position_tolerance,
        rotation_tolerance=rotation_tolerance,
        avoid=None if avoid is None else avoid._core,
    )
    return IkResult(*(array[0] for array in found)) if goal.is_single else IkResult(*found)


def inverse_kinematics(
    model: Model,
    frame: str,
    position: ArrayLike,
    quaternion: ArrayLike,
    *,
    start: ArrayLike | None = None,
    restarts: int = 100,
    seed: int = 0,
    respect_limits: bool = True,
    position_tolerance: float = 1e-5,
    rotation_tolerance: float = 1e-4,
) -> IkResult:
    """Configurations that bring `frame` to the poses `position` (3,) or (n, 3) [m], `quaternion` (4,) or (n, 4) xyzw.

    The first attempt begins at `start` (nq,), by default the neutral configuration within the limits; `restarts` more
    begin at random ones. The joints that move the frame lie within their limits unless `respect_limits` is False; all
    other coordinates stay as in `start`, wherever that is. An unreachable pose gives success False and the errors that
    remain. Quaternions are normalised. Tolerances in [m] and [rad]. The same arguments give the same bits.

    Damped least squares (Sugihara, IEEE T-RO 27(5), 2011), in SIMD lanes and finished in float64.
    Raises KeyError for an unknown frame; ValueError for a wrong shape or number, or a joint of several degrees of
    freedom between the world and the frame.
    """
    if np.shape(position)[:-1] != np.shape(quaternion)[:-1]:
        raise ValueError(
            f"position has shape {np.shape(position)} and quaternion {np.shape(quaternion)}; expected as many rows"
        )
    return inverse(
        model,
        frame,
        position=position,
        quaternion=quaternion,
        start=start,
        restarts=restarts,
        seed=seed,
        respect_limits=respect_limits,
        position_tolerance=position_tolerance,
        rotation_tolerance=rotation_tolerance,
    )


class _Goal(NamedTuple):
    """Rows of a goal, and what it asks for."""

    orientation: str
    places: bool
    is_single: bool
    position: Array
    quaternion: Array
    toward: Array


def _goal(
    position: ArrayLike | None, quaternion: ArrayLike | None, direction: ArrayLike | None, look_at: ArrayLike | None
) -> _Goal:
    given: dict[str, Array] = {}
    if position is not None:
        given["position"] = finite_rows("position", position, 3)
    if quaternion is not None:
        given["quaternion"] = unit_quaternions("quaternion", quaternion)
    if direction is not None:
        given["direction"] = _unit("direction", direction)
    if look_at is not None:
        given["look_at"] = finite_rows("look_at", look_at, 3)
    if not given:
        raise ValueError("there is no goal; give position, quaternion, direction or look_at")
    if len(given.keys() - {"position"}) > 1:
        raise ValueError("quaternion, direction and look_at are different goals of orientation; give one of them")
    for name, rows in given.items():
        if rows.ndim > 2:
            width = rows.shape[-1]
            raise ValueError(f"{name} has shape {rows.shape}; expected ({width},) or (n, {width})")
    counts = {name: len(rows) for name, rows in given.items() if rows.ndim == 2}
    if len(set(counts.values())) > 1:
        text = " and ".join(f"{name} {n}" for name, n in counts.items())
        raise ValueError(f"{text} rows; expected as many rows of each, or a single one for all")
    n = next(iter(counts.values()), 1)

    def rows_of(width: int, *names: str) -> Array:
        rows = next((given[name] for name in names if name in given), None)
        if rows is None:  # of what is not asked for
            return np.ones((n, width))
        if rows.ndim == 1:
            rows = rows[None] if n == 1 else np.tile(rows, (n, 1))
        return np.ascontiguousarray(rows)

    kinds = {"quaternion": "full", "direction": "along", "look_at": "at"}
    return _Goal(
        orientation=next((kind for name, kind in kinds.items() if name in given), "free"),
        places=position is not None,
        is_single=not counts,
        position=rows_of(3, "position"),
        quaternion=rows_of(4, "quaternion"),
        toward=rows_of(3, "direction", "look_at"),
    )


def _unit(name: str, vectors: ArrayLike) -> Array:
    """Vectors (..., 3) at length 1."""
    array = finite_rows(name, vectors, 3)
    lengths = np.linalg.norm(array, axis=-1, keepdims=True)
    if (lengths < _SHORTEST).any():
        raise ValueError(f"{name} is shorter than {_SHORTEST:g}, which leaves its direction open")
    return array / lengths


def _configuration(model: Model, name: str, values: ArrayLike) -> Array:
    q = np.asarray(values, np.float64)
    if q.shape != (model.nq,):
        raise ValueError(f"{name} has shape {q.shape}; expected ({model.nq},)")
    if not all_finite(q):
        raise ValueError(f"{name} must be finite, but is {q}")
    return q
