"""Inverse kinematics: the joint configuration that brings a frame to a goal."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _kinematics
from manyhands.arguments import instance, real_array, whole_number

if TYPE_CHECKING:
    from manyhands.planning.planner import Planner

__all__ = ["IkResult", "inverse", "inverse_all", "inverse_kinematics"]

_core: Any = _kinematics  # what it returns depends on whether there are rows

Array = NDArray[np.float64]

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
    start: (nq,) where the first attempt begins, and what other coordinates keep within limits; by default neutral.
    Where none is given, and no posture, attempts of arms of more than six joints begin near the position at once.
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
    if avoid is not None:
        from manyhands.planning.planner import Planner

        instance("avoid", avoid, Planner)
        if start is None and posture is None:
            start = avoid.configuration(avoid.start)
    found: Any = _core.inverse(
        model,
        frame,
        position,
        quaternion,
        direction,
        look_at,
        axis,
        posture,
        position_weight,
        rotation_weight,
        "" if relative_to is None else relative_to,
        None if avoid is None else avoid._core,
        start,
        whole_number("restarts", restarts, 0, 2**31 - 1),
        whole_number("seed", seed, 0, 2**64 - 1),
        respect_limits,
        position_tolerance,
        rotation_tolerance,
    )
    return IkResult(*found) if found[0].ndim == 2 else _single(*found)


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

    The first attempt begins at `start` (nq,), by default as `inverse` says; `restarts` more near the pose, then at
    random. All joints of one degree of freedom lie within their limits unless `respect_limits` is False; those that do
    not move the frame stay as near to `start` as these allow. An unreachable pose gives success False and the errors
    that remain. Quaternions are normalised. Tolerances in [m] and [rad]. The same arguments give the same bits.

    Damped least squares (Sugihara, IEEE T-RO 27(5), 2011), in SIMD lanes and finished in float64.
    Raises KeyError for an unknown frame; ValueError for a wrong shape or number, or a joint of several degrees of
    freedom between the world and the frame.
    """
    p, r = real_array("position", position), real_array("quaternion", quaternion)
    if p.shape[:-1] != r.shape[:-1]:
        raise ValueError(f"position has shape {p.shape} and quaternion {r.shape}; expected as many rows")
    return inverse(
        model,
        frame,
        position=p,
        quaternion=r,
        start=start,
        restarts=restarts,
        seed=seed,
        respect_limits=respect_limits,
        position_tolerance=position_tolerance,
        rotation_tolerance=rotation_tolerance,
    )


def inverse_all(
    model: Model, frame: str, position: ArrayLike, quaternion: ArrayLike, *, start: ArrayLike | None = None
) -> Array:
    """All configurations (k, nq), each once, within the limits that bring `frame` to a pose, position (3,) [m] and
    quaternion (4,) xyzw, in closed form: at most eight, exact to rounding, those nearest to `start` (nq,), by default
    the neutral configuration, first; k is 0 where there is none.

    Of six-axis arms whose second and third axes are parallel and whose last three axes meet in a point, or whose fourth
    axis is parallel to these, too, and whose last two meet. Angles differ from `start` by as few whole turns as limits
    allow. Of the many configurations of a singular pose some are given, those whose sixth (or fourth) joint is at 0.

    Raises KeyError for an unknown frame; ValueError for a wrong shape or number, and for arms of other kinds.
    """
    return _core.closed_form(model, frame, position, quaternion, start)


def _single(q: Array, success: Any, position_error: Any, rotation_error: Any) -> IkResult:
    return IkResult(q, np.bool_(success), np.float64(position_error), np.float64(rotation_error))  # type: ignore[arg-type]
