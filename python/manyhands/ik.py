"""Inverse kinematics: the joint configuration that brings a frame to a pose."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _core
from manyhands.arguments import whole_number

__all__ = ["IkResult", "inverse_kinematics"]

_SHORTEST_QUATERNION = 1e-6


class IkResult(NamedTuple):
    """What `inverse_kinematics` found; for n targets every field has n rows, for a single one none."""

    q: NDArray[np.float64]
    """(..., nq) the configuration: the solution, or the nearest that was found."""
    success: NDArray[np.bool_]
    """Whether both errors are within tolerance."""
    position_error: NDArray[np.float64]
    """[m]"""
    rotation_error: NDArray[np.float64]
    """[rad]"""


def inverse_kinematics(
    model: Model,
    frame: str,
    position: ArrayLike,
    quaternion: ArrayLike,
    *,
    start: ArrayLike | None = None,
    restarts: int = 30,
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
    p, r = np.asarray(position, np.float64), np.asarray(quaternion, np.float64)
    for name, array, width in (("position", p, 3), ("quaternion", r, 4)):
        if array.ndim not in (1, 2) or array.shape[-1] != width:
            raise ValueError(f"{name} has shape {array.shape}; expected ({width},) or (n, {width})")
    if p.ndim != r.ndim or p.shape[:-1] != r.shape[:-1]:
        raise ValueError(f"position has shape {p.shape} and quaternion {r.shape}; expected as many rows")
    if not (np.isfinite(p).all() and np.isfinite(r).all()):
        raise ValueError("position and quaternion must be finite")
    if (np.linalg.norm(r, axis=-1) < _SHORTEST_QUATERNION).any():
        raise ValueError(f"a quaternion is shorter than {_SHORTEST_QUATERNION:g}, which leaves its direction open")
    q0 = model.neutral_configuration() if start is None else np.asarray(start, np.float64)
    if np.shape(q0) != (model.nq,):
        raise ValueError(f"start has shape {np.shape(q0)}; expected ({model.nq},)")
    if not np.isfinite(q0).all():
        raise ValueError(f"start must be finite, but is {q0}")
    for name, tolerance in (("position_tolerance", position_tolerance), ("rotation_tolerance", rotation_tolerance)):
        if not tolerance > 0:
            raise ValueError(f"{name} is {tolerance}; expected more than 0")
    restarts = whole_number("restarts", restarts, 0, 2**31 - 1)
    seed = whole_number("seed", seed, 0, 2**64 - 1)
    found: Any = _core.search(
        model, frame, np.atleast_2d(p), np.atleast_2d(r), q0, restarts=restarts, seed=seed,
        respect_limits=respect_limits, position_tolerance=position_tolerance, rotation_tolerance=rotation_tolerance,
    )  # fmt: skip
    return IkResult(*(array[0] for array in found)) if p.ndim == 1 else IkResult(*found)
