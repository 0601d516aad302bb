"""Random pairs of shapes for us and for Coal, and what can be said of them without either: support functions and
containment, written from the shapes' definitions, for many pairs at a time.

Shapes are those of manyhands.collision: along z where they have an axis, with half lengths; a plane is the half-space
z <= 0. `Pairs` holds n pairs of two types as arrays with n rows.
"""

from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import coal
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from manyhands import collision

Array = NDArray[np.float64]

HULL_VERTICES = 10
_HULLS = 40


def unit(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)


def turned_back(R: Array, v: Array) -> Array:
    return np.einsum("...ji,...j->...i", R, v)


def lengths(rng: np.random.Generator, shape: tuple[int, ...]) -> Array:
    """2 cm to 40 cm, and in one of six cases 1 mm to 3 mm: needles, plates and slabs."""
    usual = np.exp(rng.uniform(np.log(0.02), np.log(0.4), shape))
    return np.where(rng.random(shape) < 1 / 6, rng.uniform(0.001, 0.003, shape), usual)


def rotations(rng: np.random.Generator, n: int) -> tuple[Array, Array]:
    """Matrices (n, 3, 3) and quaternions xyzw (n, 4); one in four is a quarter turn or nearly so."""
    q = unit(rng.normal(size=(n, 4)))
    half = np.sqrt(0.5)
    quarter = np.array([[0, 0, 0, 1], [half, 0, 0, half], [0, half, 0, half], [0, 0, half, half]])
    square = rng.random(n) < 0.25
    q[square] = quarter[rng.integers(4, size=square.sum())]
    tilted = square & (rng.random(n) < 0.5)
    q[tilted] += 10 ** rng.uniform(-7, -1, (tilted.sum(), 1)) * rng.normal(size=(tilted.sum(), 4))
    q = unit(q)
    return Rotation.from_quat(q).as_matrix(), q


def hull_planes(vertices: Array) -> Array:
    """The faces n . x <= d of a hull as rows (n, d), by trying every three vertices."""
    planes = []
    for i, j, k in combinations(range(len(vertices)), 3):
        n = np.cross(vertices[j] - vertices[i], vertices[k] - vertices[i])
        n /= np.linalg.norm(n)
        height = vertices @ n - vertices[i] @ n
        if height.max() < 1e-9 or height.min() > -1e-9:
            n = n if height.max() < 1e-9 else -n
            planes.append([*n, vertices[i] @ n])
    return np.array(planes)


class Hulls:
    """A stock of hulls, needles and plates among them."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.vertices = unit(rng.normal(size=(_HULLS, HULL_VERTICES, 3))) * lengths(rng, (_HULLS, 1, 3))
        planes = [hull_planes(v) for v in self.vertices]
        most = max(len(p) for p in planes)
        self.planes = np.array([np.concatenate([p, np.tile(p[:1], (most - len(p), 1))]) for p in planes])
        self.ours = [collision.Convex(v) for v in self.vertices]
        self.coal = []
        for v in self.vertices:
            points = coal.StdVec_Vec3s()
            for p in v:
                points.append(p)
            self.coal.append(coal.Convex.convexHull(points, False, ""))


@dataclass
class Side:
    """One shape of each of n pairs: a type, sizes (n, 3), which hull (n), and poses."""

    type: str
    size: Array
    hull: NDArray[np.int64]
    R: Array
    quaternion: Array
    hulls: Hulls
    p: Array = field(default_factory=lambda: np.zeros((0, 3)))

    def row(self, i: int) -> "Side":
        """One shape, to be asked about many points."""
        one = slice(i, i + 1)
        return Side(
            self.type, self.size[one], self.hull[one], self.R[one], self.quaternion[one], self.hulls, self.p[one]
        )

    def core_support(self, d: Array) -> Array:
        """In the shape's frame."""
        s = self.size
        if self.type == "sphere":
            return s[:, :1] * unit(d)
        if self.type == "capsule":
            return s[:, :1] * unit(d) + np.copysign(s[:, 1:2], d[:, 2:]) * [0, 0, 1]
        if self.type == "cylinder":
            across = d * [1, 1, 0]
            length = np.linalg.norm(across, axis=1, keepdims=True)
            side = np.where(length > 0, across / np.where(length > 0, length, 1), [1, 0, 0])
            return s[:, :1] * side + np.copysign(s[:, 1:2], d[:, 2:]) * [0, 0, 1]
        if self.type == "box":
            return np.copysign(s, d)
        if self.type == "plane":
            return np.zeros_like(d)
        vertices = self.hulls.vertices[self.hull]
        best = np.einsum("nvi,ni->nv", vertices, d).argmax(axis=1)
        return vertices[np.arange(len(d)), best]

    def support(self, n: Array) -> Array:
        """The largest n . x over the shape's points, for unit n (n, 3); a plane's is finite along its normal only."""
        d = turned_back(self.R, n)
        value = dot(d, self.core_support(d)) + dot(n, self.p)
        if self.type == "plane":
            return np.where(d[:, 2] > 1 - 1e-9, value, np.inf)
        return value

    def outside(self, x: Array) -> Array:
        """How far points (n, 3) lie outside of the shapes, at least 0; of hulls, beyond the worst face."""
        p, s = turned_back(self.R, x - self.p), self.size
        beyond = np.maximum(np.abs(p) - s, 0)
        round_ = np.linalg.norm(p[:, :2], axis=1)
        if self.type == "sphere":
            return np.maximum(np.linalg.norm(p, axis=1) - s[:, 0], 0)
        if self.type == "capsule":
            return np.maximum(np.hypot(round_, np.maximum(np.abs(p[:, 2]) - s[:, 1], 0)) - s[:, 0], 0)
        if self.type == "cylinder":
            return np.hypot(np.maximum(round_ - s[:, 0], 0), np.maximum(np.abs(p[:, 2]) - s[:, 1], 0))
        if self.type == "box":
            return np.linalg.norm(beyond, axis=1)
        if self.type == "plane":
            return np.maximum(p[:, 2], 0)
        planes = self.hulls.planes[self.hull]
        return np.maximum(np.einsum("...fi,...i->...f", planes[..., :3], p) - planes[..., 3], 0).max(axis=-1)

    def bound(self) -> Array:
        """The radius of a ball about the origin that holds the shape."""
        s = self.size
        if self.type == "plane":
            return np.zeros(len(s))
        if self.type == "convex":
            return np.linalg.norm(self.hulls.vertices[self.hull], axis=2).max(axis=1)
        return {"sphere": s[:, 0], "capsule": s[:, 0] + s[:, 1], "cylinder": np.hypot(s[:, 0], s[:, 1])}.get(
            self.type, np.linalg.norm(s, axis=1)
        )

    def ours(self, i: int) -> collision.Shape:
        x, y, z = self.size[i].tolist()
        match self.type:
            case "sphere":
                return collision.Sphere(x)
            case "capsule":
                return collision.Capsule(x, y)
            case "cylinder":
                return collision.Cylinder(x, y)
            case "box":
                return collision.Box((x, y, z))
            case "plane":
                return collision.Plane()
        return self.hulls.ours[self.hull[i]]

    def theirs(self, i: int) -> Any:
        x, y, z = self.size[i].tolist()
        match self.type:
            case "sphere":
                return coal.Sphere(x)
            case "capsule":
                return coal.Capsule(x, 2 * y)
            case "cylinder":
                return coal.Cylinder(x, 2 * y)
            case "box":
                return coal.Box(2 * x, 2 * y, 2 * z)
            case "plane":
                return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        return self.hulls.coal[self.hull[i]]


@dataclass
class Pairs:
    a: Side
    b: Side

    def lower_bound(self, n: Array) -> Array:
        """-h(n) = -s_A(n) - s_B(-n): the planes across the unit vectors n (n, 3) prove that much of phi."""
        return -self.a.support(n) - self.b.support(-n)

    def scale(self) -> Array:
        """The radii of both shapes together."""
        return self.a.bound() + self.b.bound()

    def describe(self, i: int) -> str:
        return "\n".join(
            f"{s.type} size {s.size[i].tolist()} hull {s.hull[i]} position {s.p[i].tolist()} "
            f"quaternion {s.quaternion[i].tolist()}"
            for s in (self.a, self.b)
        )

    def coal_distances(self) -> tuple[Array, Array]:
        """phi (n) and normals (n, 3) as Coal finds them."""
        request = coal.DistanceRequest()
        request.enable_signed_distance = True
        request.gjk_tolerance = request.epa_tolerance = 1e-10
        request.gjk_max_iterations = request.epa_max_iterations = 1000
        n = len(self.a.p)
        phi, normal = np.empty(n), np.empty((n, 3))
        for i in range(n):
            poses = [coal.Transform3s(side.R[i], side.p[i]) for side in (self.a, self.b)]
            result = coal.DistanceResult()
            phi[i] = coal.distance(self.a.theirs(i), poses[0], self.b.theirs(i), poses[1], request, result)
            normal[i] = result.normal
        return phi, normal


def random_pairs(rng: np.random.Generator, type_a: str, type_b: str, n: int, hulls: Hulls) -> Pairs:
    """Pairs that touch, nearly touch or overlap up to all the way, a third of them with parallel axes."""

    def side(type_: str) -> Side:
        R, q = rotations(rng, n)
        return Side(type_, lengths(rng, (n, 3)), rng.integers(_HULLS, size=n), R, q, hulls)

    a, b = side(type_a), side(type_b)
    parallel = rng.random(n) < 0.3
    b.R[parallel], b.quaternion[parallel] = a.R[parallel], a.quaternion[parallel]
    b.p = rng.uniform(-1, 1, (n, 3))
    aside = rng.uniform(-0.5, 0.5, (n, 2)) * b.size[:, ::2]
    a.p = b.p + aside[:, :1] * b.R[:, :, 0] + aside[:, 1:] * b.R[:, :, 2]
    if type_b == "plane":
        along = -b.R[:, :, 2]
    else:
        along = np.where((rng.random(n) < 0.3)[:, None], a.R[:, :, 0], unit(rng.normal(size=(n, 3))))
    pairs = Pairs(a, b)
    gap = np.where(rng.random(n) < 0.6, rng.uniform(-0.004, 0.002, n), rng.uniform(-0.15, 0.03, n))
    a.p += (pairs.lower_bound(along) - gap)[:, None] * along
    return pairs
