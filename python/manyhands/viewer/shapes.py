"""Triangles for the shapes of a model, shaded smoothly where they are smooth."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Geom, Model

Vertices = NDArray[np.float32]
Triangles = NDArray[np.uint32]

_ROUND = 48  # sides of what is round
_GLOSS_LIMIT = 0.9  # the brightest that a surface may be, so that its shading shows
_CREASE = np.cos(np.radians(38.0))  # flatter edges are smoothed


def color(rgba: Any) -> tuple[int, int, int]:
    """Of a surface, as the page takes it."""
    r, g, b = (round(255 * min(float(c), _GLOSS_LIMIT)) for c in rgba[:3])
    return r, g, b


class Surface(NamedTuple):
    """Triangles; vertices are shared where light is to pass smoothly from one to the next."""

    vertices: Vertices
    """(n, 3) [m], in the frame of the shape."""
    triangles: Triangles
    """(m, 3), counter-clockwise seen from outside."""


def surface(model: Model, geom: Geom) -> Surface | None:
    """What is seen of a geom, in its frame; None of a plane, which has no end."""
    if geom.shape == "plane":
        return None
    if geom.shape in ("mesh", "convex"):
        mesh = model.meshes[geom.mesh]
        return creased(mesh.vertices, mesh.triangles)
    if geom.shape == "height_field":
        field = model.height_fields[geom.height_field]
        return height_field(field.heights, field.dx, field.dy)
    return primitive(geom.shape, geom.size)


def primitive(shape: str, size: NDArray[np.float64]) -> Surface:
    """A sphere, capsule, cylinder or box; sizes as in `Geom.size`."""
    if shape == "box":
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return creased(corners, np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]))
    radius, half = float(size[0]), float(size[1])
    if shape == "cylinder":
        return lathe([(0, -half), (radius, -half), (radius, half), (0, half)])
    angles = np.linspace(-np.pi / 2, np.pi / 2, _ROUND // 2 + 1)
    lift = 0.0 if shape == "sphere" else half
    lower, upper = angles[: _ROUND // 4 + 1], angles[_ROUND // 4 :]
    rings = [(radius * np.cos(a), radius * np.sin(a) - lift) for a in lower]
    rings += [(radius * np.cos(a), radius * np.sin(a) + lift) for a in (upper if lift else upper[1:])]
    return lathe(rings)


def lathe(profile: list[tuple[float, float]]) -> Surface:
    """Turns (radius, z) about the z axis, from the lowest to the highest."""
    turn = np.linspace(0, 2 * np.pi, _ROUND, endpoint=False)
    rings = np.array([[(r * np.cos(a), r * np.sin(a), z) for a in turn] for r, z in profile])
    at = np.arange(len(profile) * _ROUND).reshape(len(profile), _ROUND)
    a, b, c, d = at[:-1], np.roll(at, -1, 1)[:-1], np.roll(at, -1, 1)[1:], at[1:]
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return creased(rings.reshape(-1, 3), triangles)


def height_field(heights: NDArray[np.float64], dx: float, dy: float) -> Surface:
    """Heights (rows along y, columns along x) about the origin."""
    rows, columns = heights.shape
    x, y = (np.arange(columns) - (columns - 1) / 2) * dx, (np.arange(rows) - (rows - 1) / 2) * dy
    X, Y = np.meshgrid(x, y)
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return creased(np.stack([X, Y, heights], -1).reshape(-1, 3), triangles)


def creased(vertices: NDArray[np.floating], triangles: NDArray[np.integer]) -> Surface:
    """The same triangles, their vertices shared across flat edges only: browsers shade by vertices."""
    _, welded = np.unique(np.round(np.asarray(vertices, np.float64), 7), axis=0, return_inverse=True)
    corners = welded.reshape(-1)[triangles]
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    keep = (length[:, 0] > 0) & (corners != np.roll(corners, 1, 1)).all(1)
    corners, normals, triangles = corners[keep], normals[keep] / length[keep], triangles[keep]
    fans = _fans(corners, normals)
    first, index = np.unique(fans, return_index=True)
    places = np.searchsorted(first, fans).reshape(-1, 3)
    return Surface(np.asarray(vertices[triangles.reshape(-1)[index]], np.float32), places.astype(np.uint32))


def _fans(corners: NDArray[np.integer], normals: NDArray[np.floating]) -> NDArray[np.int64]:
    """A number for each corner (3 n): the same for those about one vertex that flat edges join."""
    n = len(corners)
    start, end = corners, np.roll(corners, -1, 1)
    lower, upper = np.minimum(start, end).ravel(), np.maximum(start, end).ravel()
    order = np.lexsort((upper, lower))
    same = (lower[order][1:] == lower[order][:-1]) & (upper[order][1:] == upper[order][:-1])
    one, two = order[:-1][same], order[1:][same]
    flat = (normals[one // 3] * normals[two // 3]).sum(1) > _CREASE
    one, two = one[flat], two[flat]

    def at(edge: NDArray[np.integer], vertex: NDArray[np.integer]) -> NDArray[np.integer]:
        """The edge's corner of the vertex."""
        return np.where(start.ravel()[edge] == vertex, edge, edge // 3 * 3 + (edge + 1) % 3)

    a = np.concatenate([at(one, lower[one]), at(one, upper[one])])
    b = np.concatenate([at(two, lower[one]), at(two, upper[one])])
    label = np.arange(3 * n)
    while True:
        least = np.minimum(label[a], label[b])
        new = label.copy()
        np.minimum.at(new, label[a], least)
        np.minimum.at(new, label[b], least)
        new = new[new]
        if (new == label).all():
            return label
        label = new
