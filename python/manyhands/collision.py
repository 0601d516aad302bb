"""Shapes outside of any model: how far two of them are from each other, where they touch, and where a ray meets one.

A pose is a pair (position, quaternion xyzw) in the world. Functions that take rows take (3,) and (4,) for one pose or
(n, 3) and (n, 4) for n; where one argument has n rows the others have n or one, and the results have n rows in front.
Lengths are in metres. What is wrong with an argument is said by a ValueError.

Everything is computed in float64. `contact_points` alone runs the code of a step, in the number type it is asked for.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from manyhands._core import collision as _core
from manyhands._core.collision import Capsule, Cylinder, Plane, Shape, Sphere

__all__ = [
    "Box",
    "Capsule",
    "ContactPoints",
    "Convex",
    "Cylinder",
    "Distance",
    "HeightField",
    "Mesh",
    "Plane",
    "Pose",
    "RayHit",
    "Shape",
    "Sphere",
    "contact_points",
    "ray_cast",
    "signed_distance",
]

Pose: TypeAlias = tuple[ArrayLike, ArrayLike]
"""Position (3,) or (n, 3) [m] and quaternion xyzw, of unit length, (4,) or (n, 4)."""


def _numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.asarray(values, np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is not an array of real numbers: {error}") from None


class Box(_core.BoxShape):
    """A box about the origin."""

    def __init__(self, half_extents: ArrayLike) -> None:
        """half_extents (3,) [m], above 0."""
        super().__init__(_numbers("half_extents", half_extents))


class Convex(_core.ConvexShape):
    """The convex hull of points. Flat clouds are thickened by 1e-4 of their extent."""

    def __init__(self, vertices: ArrayLike) -> None:
        """vertices (n, 3) [m]."""
        super().__init__(_numbers("vertices", vertices))


class Mesh(_core.MeshShape):
    """Triangles as a surface without thickness, touched from their front. Vertices are rounded to float32."""

    def __init__(self, vertices: ArrayLike, triangles: ArrayLike) -> None:
        """vertices (n, 3) [m]; triangles (m, 3), indices counter-clockwise seen from the front."""
        indices = np.asarray(triangles)
        if indices.ndim != 2 or indices.dtype.kind not in "iu":
            raise ValueError(f"triangles have shape {indices.shape} of {indices.dtype}; expected (m, 3) whole numbers")
        if indices.size > 0 and (indices.min() < 0 or indices.max() > np.iinfo(np.int32).max):
            raise ValueError("triangles hold an index that names no vertex")
        super().__init__(_numbers("vertices", vertices), np.asarray(indices, np.int32, order="C"))


class HeightField(_core.HeightFieldShape):
    """The solid ground below a grid of heights in the xy plane, centred on the origin."""

    def __init__(self, heights: ArrayLike, dx: float, dy: float) -> None:
        """heights (rows along y, columns along x) [m]; dx, dy: spacing [m]."""
        super().__init__(_numbers("heights", heights), dx, dy)


class Distance(NamedTuple):
    """What `signed_distance` found; with rows, every field has them in front."""

    phi: NDArray[np.float64]
    """(...) negative in penetration: b must then move by -phi along the normal to be free."""
    point_a: NDArray[np.float64]
    """(..., 3) on a's surface, the nearest to b or the deepest in it."""
    point_b: NDArray[np.float64]
    """(..., 3) on b's surface: point_a + phi normal."""
    normal: NDArray[np.float64]
    """(..., 3) unit, from a to b."""


class ContactPoints(NamedTuple):
    """What `contact_points` found: k points, none if the shapes are farther apart than the margin."""

    normal: NDArray[Any]
    """(k, 3) unit, from a to b; the same for all points unless one shape is a mesh or a height field."""
    points: NDArray[Any]
    """(k, 3) midway between the surfaces."""
    distances: NDArray[Any]
    """(k,) along the normal, negative in penetration."""


class RayHit(NamedTuple):
    """Where a ray meets a shape; with rows, every field has them in front."""

    distance: NDArray[np.float64]
    """(...) along the ray; infinite where it misses."""
    point: NDArray[np.float64]
    """(..., 3); NaN where it misses."""
    normal: NDArray[np.float64]
    """(..., 3) unit, of the surface, against the ray; NaN where it misses."""


def _pose(name: str, pose: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    try:
        position, quaternion = pose
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a pair (position, quaternion xyzw)") from None
    return _numbers(f"{name}'s position", position), _numbers(f"{name}'s quaternion", quaternion)


def _shapes(name: str, shapes: Shape | Sequence[Shape]) -> list[Shape]:
    given = [shapes] if isinstance(shapes, Shape) else list(shapes)
    for shape in given:
        if not isinstance(shape, Shape):
            raise ValueError(f"{name} holds {shape!r}; expected shapes of manyhands.collision")
    return given


def signed_distance(a: Shape | Sequence[Shape], pose_a: Pose, b: Shape | Sequence[Shape], pose_b: Pose) -> Distance:
    """The signed distance of two shapes, or of n pairs of them: shapes, too, may come as a sequence of n.

    Exact for convex shapes, in depth as well; where directions tie, one of them. Planes are half-spaces, the ground of
    a height field is solid, and a mesh is a surface: within a closed one a shape is as far from it as from the nearest
    triangle. GJK (Gilbert, Johnson, Keerthi 1988) and EPA (van den Bergen 2001).
    """
    p_a, q_a = _pose("pose_a", pose_a)
    p_b, q_b = _pose("pose_b", pose_b)
    found = _core.signed_distance(_shapes("a", a), p_a, q_a, _shapes("b", b), p_b, q_b)
    single = isinstance(a, Shape) and isinstance(b, Shape) and p_a.ndim == 1 and p_b.ndim == 1
    return Distance(*(array[0] for array in found)) if single else Distance(*found)


def contact_points(
    a: Shape, pose_a: Pose, b: Shape, pose_b: Pose, margin: float = 0.0, *, dtype: DTypeLike = np.float64
) -> ContactPoints:
    """Where two shapes touch or are at most `margin` [m] apart: up to four points, or up to four for each of up to four
    normals against meshes and height fields.

    This is what the physics sees: the same dispatch, in float64 as a World or in float32, bit for bit, as each world of
    a Batch. Raises ValueError for two of plane, mesh and height field: the physics does not look for their contact.
    """
    find = {"float64": _core.contact_points_float64, "float32": _core.contact_points_float32}.get(np.dtype(dtype).name)
    if find is None:
        raise ValueError(f"dtype is {np.dtype(dtype)}; expected float64 or float32")
    for name, shape in (("a", a), ("b", b)):
        if not isinstance(shape, Shape):
            raise ValueError(f"{name} is {shape!r}; expected a shape of manyhands.collision")
    return ContactPoints(*find(a, *_pose("pose_a", pose_a), b, *_pose("pose_b", pose_b), margin))


def ray_cast(shape: Shape, pose: Pose, origin: ArrayLike, direction: ArrayLike, max_distance: float = np.inf) -> RayHit:
    """The first point of a shape on the ray from `origin` (3,) or (n, 3) along `direction`, of any length above 0, no
    farther than `max_distance` [m].

    A ray that starts inside a solid meets it at distance 0, head on. The triangles of a mesh are met from both sides.
    """
    if not isinstance(shape, Shape):
        raise ValueError(f"shape is {shape!r}; expected a shape of manyhands.collision")
    position, quaternion = _pose("pose", pose)
    o, d = _numbers("origin", origin), _numbers("direction", direction)
    found = _core.ray_cast(shape, position, quaternion, o, d, max_distance)
    single = position.ndim == 1 and o.ndim == 1 and d.ndim == 1
    return RayHit(*(array[0] for array in found)) if single else RayHit(*found)
