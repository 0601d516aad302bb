"""Triangle meshes: from distance fields (surface nets), lathes, prisms and convex hulls; written as OBJ."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import numpy.typing as npt

from robots.sdf import Array, Field

Index = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Mesh:
    """Closed triangle mesh, counter-clockwise from outside; each triangle corner has its own normal index."""

    vertices: Array  # (n, 3) m
    faces: Index  # (t, 3) into vertices
    normals: Array  # (m, 3) unit
    normal_faces: Index  # (t, 3) into normals

    def to_obj(self, script: str) -> str:
        """OBJ text written by `script`, 0.01 mm and 1/1000 in the normals."""

        def row(tag: str, values: Array, digits: int) -> str:
            # Adding zero turns -0.0 into 0.0.
            return tag + " " + " ".join(f"{v:.{digits}f}" for v in np.round(values, digits) + 0.0)

        lines = [f"# Part of the manyhands arm; written by {script}."]
        lines += [row("v", v, 5) for v in self.vertices]
        lines += [row("vn", n, 3) for n in self.normals]
        for face, normal in zip(self.faces + 1, self.normal_faces + 1, strict=True):
            lines.append("f " + " ".join(f"{v}//{n}" for v, n in zip(face, normal, strict=True)))
        return "\n".join(lines) + "\n"


def join(meshes: list[Mesh]) -> Mesh:
    """All meshes in one."""
    v = np.cumsum([0] + [len(m.vertices) for m in meshes])
    n = np.cumsum([0] + [len(m.normals) for m in meshes])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + o for m, o in zip(meshes, v[:-1], strict=True)]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.normal_faces + o for m, o in zip(meshes, n[:-1], strict=True)]),
    )


def length(v: Array) -> Array:
    """Euclidean norms along the last axis, in an order of operations that does not depend on BLAS."""
    return np.sqrt(v[..., 0] ** 2 + v[..., 1] ** 2 + v[..., 2] ** 2)


def cross(a: Array, b: Array) -> Array:
    """Vector products of rows."""
    return np.stack(
        [
            a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1],
            a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2],
            a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0],
        ],
        axis=-1,
    )


def _gradient(field: Field, p: Array, h: float = 1e-5) -> Array:
    x, y, z = p[:, 0], p[:, 1], p[:, 2]
    return np.stack(
        [
            (field(x + h, y, z) - field(x - h, y, z)) / (2 * h),
            (field(x, y + h, z) - field(x, y - h, z)) / (2 * h),
            (field(x, y, z + h) - field(x, y, z - h)) / (2 * h),
        ],
        axis=-1,
    )


def _project(field: Field, p: Array, rounds: int) -> Array:
    for _ in range(rounds):
        g = _gradient(field, p)
        scale = field(p[:, 0], p[:, 1], p[:, 2]) / np.maximum(length(g) ** 2, 0.25)
        p = p - scale[:, None] * g
    return p


def _net_vertices(values: Array) -> tuple[Array, Index]:
    """One vertex per sign-changing cell, at the mean of its edge crossings; (vertices in cells, cell -> vertex)."""
    shape = tuple(n - 1 for n in values.shape)
    total, count = np.zeros((*shape, 3)), np.zeros(shape)
    corners = [(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    for a, b in combinations(corners, 2):
        if sum(abs(s - t) for s, t in zip(a, b, strict=True)) != 1:
            continue
        va = values[tuple(slice(o, o + n) for o, n in zip(a, shape, strict=True))]
        vb = values[tuple(slice(o, o + n) for o, n in zip(b, shape, strict=True))]
        crosses = (va < 0) != (vb < 0)
        t = np.where(crosses, va / np.where(crosses, va - vb, 1.0), 0.0)
        for axis in range(3):
            total[..., axis] += np.where(crosses, a[axis] + t * (b[axis] - a[axis]), 0.0)
        count += crosses
    active = np.argwhere(count > 0)
    key = tuple(active.T)
    number = np.full(shape, -1, dtype=np.int64)
    number[key] = np.arange(len(active))
    return active + total[key] / count[key][:, None], number


def _net_quads(values: Array, number: Index) -> Index:
    """A quadrilateral around every sign-changing grid edge, counter-clockwise from outside."""
    quads = []
    for axis in range(3):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        low = [slice(1, -1)] * 3
        high = [slice(1, -1)] * 3
        low[axis], high[axis] = slice(0, -1), slice(1, None)
        inside_low, inside_high = values[tuple(low)] < 0, values[tuple(high)] < 0
        edges = np.argwhere(inside_low != inside_high)
        leaving = inside_low[tuple(edges.T)]
        cell = edges.copy()
        cell[:, j] += 1
        cell[:, k] += 1
        ring = []
        for dj, dk in ((1, 1), (0, 1), (0, 0), (1, 0)):
            c = cell.copy()
            c[:, j] += dj - 1
            c[:, k] += dk - 1
            ring.append(number[tuple(c.T)])
        quad = np.stack(ring, axis=-1)
        quads.append(np.where(leaving[:, None], quad, quad[:, ::-1]))
    return np.concatenate(quads)


def _relax(field: Field, p: Array, quads: Index, rounds: int) -> Array:
    """Even out the vertices along the surface: each goes half way to the mean of its neighbours, then back onto it."""
    a, b = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    degree = np.bincount(a, minlength=len(p)) + np.bincount(b, minlength=len(p))
    for _ in range(rounds):
        mean = np.stack(
            [np.bincount(a, p[b, i], minlength=len(p)) + np.bincount(b, p[a, i], minlength=len(p)) for i in range(3)],
            axis=-1,
        )
        p = _project(field, 0.5 * p + 0.5 * mean / degree[:, None], 1)
    return p


def from_field(field: Field, low: tuple[float, float, float], high: tuple[float, float, float], cell: float) -> Mesh:
    """Mesh of {field = 0}, which must lie inside the box, by surface nets (Gibson 1998) with `cell` spacing."""
    # A shift of the grid by an odd fraction of a cell keeps flat faces away from grid points.
    origin = np.asarray(low) - cell * np.array([1.37, 1.43, 1.41])
    counts = [math.ceil((b - a) / cell) + 4 for a, b in zip(low, high, strict=True)]
    grid = [origin[i] + cell * np.arange(counts[i]) for i in range(3)]
    values = field(*np.meshgrid(*grid, indexing="ij"))
    cells, number = _net_vertices(values)
    quads = _net_quads(values, number)
    p = _relax(field, _project(field, origin + cell * cells, 3), quads, 4)
    p = _project(field, p, 3)
    g = _gradient(field, p)
    normals = g / length(g)[:, None]
    short = length(p[quads[:, 0]] - p[quads[:, 2]]) <= length(p[quads[:, 1]] - p[quads[:, 3]])
    halves = np.where(short[:, None], quads[:, [0, 1, 2, 0, 2, 3]], quads[:, [1, 2, 3, 1, 3, 0]])
    faces = halves.reshape(-1, 3)
    return Mesh(p, faces, normals, faces)


def shade(vertices: Array, faces: Index, crease_degrees: float = 35.0) -> Mesh:
    """Give a mesh corner normals: smooth across edges flatter than the crease angle, sharp across the others."""
    area = cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    unit = area / length(area)[:, None]
    around: list[list[int]] = [[] for _ in vertices]
    for f, face in enumerate(faces):
        for v in face:
            around[v].append(f)
    limit = math.cos(math.radians(crease_degrees))
    normals: list[tuple[float, float, float]] = []
    seen: dict[tuple[float, float, float], int] = {}
    corner = np.zeros_like(faces)
    for f, face in enumerate(faces):
        for c, v in enumerate(face):
            total = np.zeros(3)
            for g in around[v]:
                if float((unit[f] * unit[g]).sum()) >= limit:
                    total = total + area[g]
            n = np.round(total / length(total), 3) + 0.0
            key = (float(n[0]), float(n[1]), float(n[2]))
            if key not in seen:
                seen[key] = len(normals)
                normals.append(key)
            corner[f, c] = seen[key]
    return Mesh(vertices, faces, np.array(normals), corner)


def lathe(
    axis: str, profile: list[tuple[float, float]], centre: tuple[float, float, float], segments: int = 32
) -> Mesh:
    """Solid of revolution about `axis` through `centre`.

    `profile` lists (radius, height along the axis) with the solid on its left. It starts and ends on the axis (radius
    0), or it is a closed loop that stays away from the axis.
    """
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    turn = [(math.cos(2 * math.pi * s / segments), math.sin(2 * math.pi * s / segments)) for s in range(segments)]
    vertices: list[list[float]] = []
    rings: list[list[int]] = []
    for radius, height in profile:
        ring = []
        for c, s in turn if radius > 0 else [(0.0, 0.0)]:
            p = list(centre)
            p[i] += height
            p[j] += radius * c
            p[k] += radius * s
            ring.append(len(vertices))
            vertices.append(p)
        rings.append(ring if radius > 0 else ring * segments)
    pairs = list(pairwise(rings))
    if profile[0][0] > 0:
        pairs.append((rings[-1], rings[0]))
    faces = []
    for a, b in pairs:
        for s in range(segments):
            t = (s + 1) % segments
            faces += [f for f in ([a[s], a[t], b[t]], [a[s], b[t], b[s]]) if len(set(f)) == 3]
    return shade(np.array(vertices), np.array(faces))


def disc(
    axis: str,
    low: float,
    high: float,
    radius: float,
    bevel: float,
    centre: tuple[float, float, float],
    segments: int = 32,
) -> Mesh:
    """Cylinder with both rims rounded by an arc of radius `bevel`."""
    arc = [(math.sin(a), math.cos(a)) for a in (math.radians(d) for d in (0, 45, 90))]
    lower = [(radius - bevel + bevel * s, low + bevel - bevel * c) for s, c in arc]
    upper = [(radius - bevel + bevel * s, high - bevel + bevel * c) for s, c in reversed(arc)]
    return lathe(axis, [(0.0, low), *lower, *upper, (0.0, high)], centre, segments)


def band(
    axis: str,
    low: float,
    high: float,
    inner: float,
    outer: float,
    centre: tuple[float, float, float],
    bevel: float = 0.0008,
) -> Mesh:
    """Ring with bevelled edges."""
    b = bevel
    profile = [(inner + b, low), (outer - b, low), (outer, low + b), (outer, high - b), (outer - b, high)]
    return lathe(axis, [*profile, (inner + b, high), (inner, high - b), (inner, low + b)], centre)


def prism(outline: list[tuple[float, float]], half_width: float, bevel: float) -> Mesh:
    """Outline in (y, z), counter-clockwise seen from +x, drawn out over |x| <= half_width with bevelled rims.

    The outline must be star-shaped about its mean.
    """
    points = np.array(outline)
    edge = np.roll(points, -1, axis=0) - points
    size = np.sqrt(edge[:, 0] ** 2 + edge[:, 1] ** 2)
    inward = np.stack([-edge[:, 1], edge[:, 0]], axis=-1) / size[:, None]
    before = np.roll(inward, 1, axis=0)
    mitre = (inward + before) / (1.0 + (inward * before).sum(axis=1))[:, None]
    inner = points + bevel * mitre
    x = [-half_width, -half_width + bevel, half_width - bevel, half_width]
    n = len(points)
    rows = [np.column_stack([np.full(n, h), r]) for h, r in zip(x, (inner, points, points, inner), strict=True)]
    middle = points.mean(axis=0)
    ends = [[-half_width, *middle], [half_width, *middle]]
    faces = []
    for s in range(n):
        t = (s + 1) % n
        for r in range(3):
            a, b = r * n, (r + 1) * n
            faces += [[a + s, b + t, a + t], [a + s, b + s, b + t]]
        faces += [[4 * n, s, t], [4 * n + 1, 3 * n + t, 3 * n + s]]
    return shade(np.concatenate([*rows, np.array(ends)]), np.array([[f[0], f[2], f[1]] for f in faces]))


def convex_hull(points: Array) -> Mesh:
    """Convex hull of at most some dozens of points: every plane through three of them with none outside is a face."""
    points = np.unique(np.round(points, 5), axis=0)
    sides: dict[frozenset[int], Array] = {}
    for triple in combinations(range(len(points)), 3):
        a, b, c = points[list(triple)]
        normal = cross(b - a, c - a)
        size = float(length(normal))
        if size < 1e-12:
            continue
        normal = normal / size
        height = ((points - a) * normal).sum(axis=1)
        for n, h in ((normal, height), (-normal, -height)):
            if h.max() < 2e-5:
                sides.setdefault(frozenset(np.flatnonzero(h > -2e-5).tolist()), n)
    largest = [s for s in sides if not any(s < t for t in sides)]
    faces = []
    for side in sorted(largest, key=sorted):
        n = sides[side]
        ids = sorted(side)
        middle = points[ids].mean(axis=0)
        u = points[ids[0]] - middle
        v = cross(n, u)
        arms = points[ids] - middle
        angle = np.arctan2((arms * v).sum(axis=1), (arms * u).sum(axis=1))
        loop = [i for _, i in sorted(zip(angle, ids, strict=True))]
        faces += [[loop[0], loop[s], loop[s + 1]] for s in range(1, len(loop) - 1)]
    used = sorted({i for f in faces for i in f})
    number = {v: i for i, v in enumerate(used)}
    return shade(points[used], np.array([[number[i] for i in f] for f in faces]), crease_degrees=1.0)
