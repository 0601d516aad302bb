"""Distances of goals, over the last axis."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

_DECIMALS = 6


def distance(a: ArrayLike, b: ArrayLike) -> Any:
    """Euclidean distances (...) of points (..., n), to six decimals. The shapes must be equal."""
    a, b = _of_one_shape(a, b)
    return np.round(np.linalg.norm(a - b, axis=-1), _DECIMALS)


def angle_distance(a: ArrayLike, b: ArrayLike) -> Any:
    """1 - <a, b>² = sin²(angle / 2) of the turn between unit quaternions (..., 4), of which q and -q are the same. The
    shapes must be equal."""
    a, b = _of_one_shape(a, b)
    return 1 - np.sum(a * b, axis=-1) ** 2


def _of_one_shape(a: ArrayLike, b: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    a, b = np.asarray(a), np.asarray(b)
    assert a.shape == b.shape, f"the shapes {a.shape} and {b.shape} differ"
    return a, b
