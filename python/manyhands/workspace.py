"""Where a frame can be, and how well it moves there."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _core
from manyhands.arguments import instance, whole_number

__all__ = ["Workspace", "workspace"]

_MOST_SAMPLES = 1_000_000
_PIECE = 65_536  # samples between two looks for Ctrl-C

Array = NDArray[np.float64]


class Workspace(NamedTuple):
    """Samples of what a frame reaches; self-collision is not looked at."""

    frame: str
    q: Array
    """(n, nq) configurations within the limits"""
    position: Array
    """(n, 3) of the frame in the world [m]"""
    quaternion: Array
    """(n, 4) xyzw"""
    measure: Array
    """(n,) Yoshikawa's manipulability of the linear velocity"""
    isotropy: Array
    """(n,) shortest over longest semi-axis of the ellipsoid, 0 to 1"""


def workspace(model: Model, frame: str, samples: int = 20_000, seed: int = 0) -> Workspace:
    """Where `frame` is at `samples` random configurations, and how well the joints move it there.

    Joints of one degree of freedom are drawn uniformly between their limits, angles without limits from a whole turn;
    all others stay neutral. The same seed gives the same bits.

    Raises KeyError for an unknown frame; ValueError for a wrong number, or a sliding joint without limits.
    """
    samples = whole_number("samples", samples, 1, _MOST_SAMPLES)
    rng = np.random.default_rng(whole_number("seed", seed, 0, 2**64 - 1))
    lower, upper = _ranges(instance("model", model, Model))
    parts: list[tuple[Array, ...]] = []
    for first in range(0, samples, _PIECE):
        q = rng.uniform(lower, upper, (min(_PIECE, samples - first), model.nq))
        position, quaternion = _core.forward(model, q, frame)
        measure, _, isotropy, *_ = _core.manipulability(model, q, frame, "linear")
        parts.append((q, position, quaternion, measure, isotropy))
    return Workspace(frame, *(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _ranges(model: Model) -> tuple[Array, Array]:
    """Between what each coordinate is drawn."""
    lower = model.neutral_configuration()
    upper = lower.copy()
    for joint in model.joints:
        if joint.type not in ("revolute", "continuous", "prismatic"):
            continue
        low, high = float(joint.lower), float(joint.upper)
        if not np.isfinite([low, high]).all():
            if joint.type == "prismatic":
                raise ValueError(f"joint '{joint.name}' slides without limits, so the workspace has no bounds")
            low, high = max(low, -np.pi), min(high, np.pi)
        lower[joint.iq], upper[joint.iq] = low, high
    return lower, upper
