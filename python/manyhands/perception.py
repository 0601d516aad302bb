"""Clouds of points: clusters, planes and boxes, and things told apart by colour.

Points are (n, 3) [m] in any frame. Those that are not finite, as cameras give where they see nothing, belong to
nothing. Wrong shapes raise ValueError.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import perception as _core
from manyhands.arguments import bounded, cloud_rows, number, rate, real_array, whole

__all__ = ["OrientedBox", "Plane", "by_colour", "dbscan", "find_plane", "nearest", "oriented_box"]

Array = NDArray[np.float64]


def dbscan(points: ArrayLike, reach: float, min_samples: int = 3) -> NDArray[np.int32]:
    """The cluster (n,) of every point, from 0 on, or -1 of noise (Ester and others, 1996). A point with min_samples
    points within reach [m], itself included, is a core; cores within reach of each other are one cluster, and so is
    what lies within reach of a core."""
    return np.asarray(
        _core.dbscan(
            cloud_rows("points", points), number("reach", reach, above=0), whole("min_samples", min_samples, 1)
        ),
        np.int32,
    )


class Plane(NamedTuple):
    """Points p with normal @ p = offset."""

    normal: Array
    """(3,), unit; its largest component is positive"""
    offset: float
    """[m]"""
    inliers: NDArray[np.bool_]
    """(n,) which points lie on it"""


def find_plane(
    points: ArrayLike, threshold: float = 0.01, *, iterations: int = 200, seed: int = 0, least_share: float = 0.1
) -> Plane | None:
    """The plane with most points within threshold [m]: a table or a floor (random sample consensus, Fischler and
    Bolles, 1981, then least squares). None if it has less than least_share of the points. `points[~plane.inliers]` is
    what stands on it."""
    found: Any = _core.find_plane(
        cloud_rows("points", points),
        number("threshold", threshold, above=0),
        whole("iterations", iterations, 1, 2**31 - 1),
        whole("seed", seed, 0, 2**32 - 1),
        rate("least_share", least_share),
    )
    return None if found is None else Plane(*found)


class OrientedBox(NamedTuple):
    """A box around points."""

    position: Array
    """(3,) of its centre [m]"""
    quaternion: Array
    """(4,) xyzw: along its edges"""
    half_extents: Array
    """(3,) [m]"""


def oriented_box(points: ArrayLike, *, upright: bool = True) -> OrientedBox:
    """A tight box around points: one that stands upright, its outline the rectangle of least area, or one along the
    principal axes. x is the longer side. Raises ValueError if no point is finite."""
    return OrientedBox(*_core.oriented_box(cloud_rows("points", points), upright))


def nearest(points: ArrayLike, queries: ArrayLike) -> tuple[NDArray[np.intp], Array]:
    """The index (m,) of the point nearest to each query (m, 3), and the distance (m,) [m]; -1 and infinity without
    any."""
    index, distance = _core.nearest(cloud_rows("points", points), cloud_rows("queries", queries))
    return np.asarray(index, np.intp), distance


def by_colour(rgb: ArrayLike, colour: ArrayLike, tolerance: float = 0.15) -> NDArray[np.bool_]:
    """Where a picture (height, width, 3 or 4), bytes or numbers of 0 to 1, has a colour (3,) of 0 to 1: what is
    brighter or darker counts, too. tolerance: of chromaticities, which are shares of red, green and blue."""
    given = real_array("rgb", rgb)
    if given.ndim != 3 or given.shape[2] not in (3, 4):
        raise ValueError(f"rgb has shape {given.shape}; expected (height, width, 3) or (height, width, 4)")
    picture = given[..., :3].astype(np.float64) / (255.0 if given.dtype == np.uint8 else 1.0)
    wanted, off = bounded("colour", colour, least=0), number("tolerance", tolerance, above=0)
    if wanted.shape != (3,) or not wanted.sum() > 0:
        raise ValueError(f"colour is {colour}; expected three numbers, not all 0")
    light = picture.sum(-1, keepdims=True)
    shares = picture / np.maximum(light, 1e-9)
    return (np.abs(shares - wanted / wanted.sum()).max(-1) < off) & (light[..., 0] > 0.15)
