"""Rotations and rigid transforms: homogeneous matrices (4, 4), quaternions (x, y, z, w), Euler angles [rad].

Euler angles come with their axes: "sxyz" turns about the fixed x, then y, then z; "rzyx" about z, then the turned y and
x; any three letters whose neighbours differ.
"""

import math
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


# ---- vectors -----------------------------------------------------------------------------------------------------


def vector_norm(data: ArrayLike, axis: int | None = None) -> Any:
    """Length of a vector, or of those along an axis."""
    return np.linalg.norm(np.asarray(data, np.float64), axis=axis)


def unit_vector(data: ArrayLike, axis: int | None = None) -> Array:
    """A vector of length 1, or those along an axis."""
    numbers = np.asarray(data, np.float64)
    return numbers / np.linalg.norm(numbers, axis=axis, keepdims=axis is not None)


# ---- matrices ----------------------------------------------------------------------------------------------------


def identity_matrix() -> Array:
    """The transform that changes nothing."""
    return np.eye(4)


def translation_matrix(direction: ArrayLike) -> Array:
    """Moves by a vector (3)."""
    matrix = np.eye(4)
    matrix[:3, 3] = np.asarray(direction)[:3]
    return matrix


def translation_from_matrix(matrix: ArrayLike) -> Array:
    """The vector (3) that it moves the origin by."""
    return np.array(matrix, np.float64)[:3, 3]


def rotation_matrix(angle: float, direction: ArrayLike, point: ArrayLike | None = None) -> Array:
    """Turns about an axis (3) through a point (3), the origin unless given."""
    matrix = quaternion_matrix(quaternion_about_axis(angle, direction))
    if point is not None:
        center = np.asarray(point, np.float64)[:3]
        matrix[:3, 3] = center - matrix[:3, :3] @ center
    return matrix


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Array:
    """Turns by Euler angles."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def inverse_matrix(matrix: ArrayLike) -> Array:
    """The transform back."""
    return np.asarray(np.linalg.inv(np.asarray(matrix, np.float64)), np.float64)


def concatenate_matrices(*matrices: ArrayLike) -> Array:
    """The product of transforms: the last acts first."""
    return reduce(np.matmul, (np.asarray(matrix, np.float64) for matrix in matrices), np.eye(4))


def is_same_transform(matrix0: ArrayLike, matrix1: ArrayLike) -> bool:
    """Whether two matrices do the same, whatever they are multiplied by."""
    a, b = (np.array(matrix, np.float64) for matrix in (matrix0, matrix1))
    return np.allclose(a / a[3, 3], b / b[3, 3])


# ---- Euler angles ------------------------------------------------------------------------------------------------


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Array:
    """The quaternion (4) of Euler angles."""
    (a, b, c), angles = _fixed(axes, (ai, aj, ak))
    turns = [quaternion_about_axis(angle, np.eye(3)[axis]) for axis, angle in zip((a, b, c), angles, strict=True)]
    return quaternion_multiply(turns[2], quaternion_multiply(turns[1], turns[0]))


def euler_from_matrix(matrix: ArrayLike, axes: str = "sxyz") -> tuple[float, float, float]:
    """Euler angles of a matrix; where two of them turn about one axis, the one that acts last is 0."""
    R = np.asarray(matrix, np.float64)[:3, :3]
    (a, b, c), _ = _fixed(axes, (0.0, 0.0, 0.0))
    d = 3 - a - b
    sign = 1.0 if (b - a) % 3 == 1 else -1.0
    if a == c:
        i, k = (sign * R[a, b], R[a, d]), (sign * R[b, a], -R[d, a])
        turns_twice = math.hypot(*i)
        sine, cosine = sign * turns_twice, R[a, a]
    else:
        i, k = (sign * R[c, b], R[c, c]), (sign * R[b, a], R[a, a])
        sine, cosine = -sign * R[c, a], math.hypot(*k)
        turns_twice = cosine
    if turns_twice < 1e-12:
        i, k = (-sign * R[b, d], R[b, b]), (0.0, 1.0)
    first, second, third = math.atan2(*i), math.atan2(sine, cosine), math.atan2(*k)
    return (first, second, third) if axes[0] == "s" else (third, second, first)


def euler_from_quaternion(quaternion: ArrayLike, axes: str = "sxyz") -> tuple[float, float, float]:
    """Euler angles of a quaternion (4)."""
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def _fixed(axes: str, angles: tuple[float, float, float]) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Axes that stay, 0 to 2, and the angles about them in the order in which they act: turned axes act backwards."""
    letters = axes[1:]
    known = len(axes) == 4 and axes[0] in "sr" and set(letters) <= set("xyz")
    if not known or letters[0] == letters[1] or letters[1] == letters[2]:
        raise ValueError(f"axes are {axes!r}; expected 's' or 'r' and three of x, y, z, neighbours different: 'sxyz'")
    numbers = tuple("xyz".index(letter) for letter in letters)
    return (numbers, angles) if axes[0] == "s" else (numbers[::-1], angles[::-1])


# ---- quaternions -------------------------------------------------------------------------------------------------


def quaternion_about_axis(angle: float, axis: ArrayLike) -> Array:
    """A turn about an axis (3)."""
    return np.append(math.sin(angle / 2) * unit_vector(np.asarray(axis)[:3]), math.cos(angle / 2))


def quaternion_matrix(quaternion: ArrayLike) -> Array:
    """The matrix (4, 4) of a quaternion (4) of any length above 0."""
    x, y, z, w = unit_vector(np.asarray(quaternion)[:4])
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return matrix


def quaternion_from_matrix(matrix: ArrayLike) -> Array:
    """The quaternion (4) of a rotation matrix (4, 4) or (3, 3)."""
    R = np.asarray(matrix, np.float64)[:3, :3]
    twist = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    # Each row is the quaternion times four times one of its numbers; that of the largest is the most exact.
    rows = np.empty((4, 4))
    rows[:3, :3] = R + R.T + (1 - np.trace(R)) * np.eye(3)
    rows[:3, 3] = rows[3, :3] = twist
    rows[3, 3] = 1 + np.trace(R)
    return unit_vector(rows[np.argmax(np.diag(rows))])


def quaternion_multiply(quaternion1: ArrayLike, quaternion0: ArrayLike) -> Array:
    """The product: quaternion0 acts first."""
    a, b = np.asarray(quaternion1, np.float64), np.asarray(quaternion0, np.float64)
    return np.append(a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3])


def quaternion_conjugate(quaternion: ArrayLike) -> Array:
    """The turn back, of a unit quaternion."""
    return np.asarray(quaternion, np.float64) * [-1, -1, -1, 1]


def quaternion_inverse(quaternion: ArrayLike) -> Array:
    """What gives 1 as a product with it."""
    numbers = np.asarray(quaternion, np.float64)
    return quaternion_conjugate(numbers) / (numbers @ numbers)


def quaternion_slerp(
    quat0: ArrayLike, quat1: ArrayLike, fraction: float, spin: int = 0, shortestpath: bool = True
) -> Array:
    """Between two quaternions, at a constant rate: quat0 at fraction 0, quat1 at 1. spin: half turns added."""
    start, end = unit_vector(quat0), unit_vector(quat1)
    cosine = float(start @ end)
    if shortestpath and cosine < 0:
        end, cosine = -end, -cosine
    angle = math.acos(min(max(cosine, -1.0), 1.0)) + spin * math.pi
    if abs(angle) < 1e-12 or abs(math.sin(angle)) < 1e-15:
        return start
    return (math.sin((1 - fraction) * angle) * start + math.sin(fraction * angle) * end) / math.sin(angle)


def random_quaternion(rand: ArrayLike | None = None) -> Array:
    """Any turn is as likely as any other. rand: three numbers between 0 and 1, drawn unless given."""
    r, s, t = np.random.rand(3) if rand is None else np.asarray(rand)  # noqa: NPY002  programs seed numpy's own
    inner, outer = math.sqrt(1 - r), math.sqrt(r)
    first, second = 2 * math.pi * s, 2 * math.pi * t
    return np.array(
        [inner * math.sin(first), inner * math.cos(first), outer * math.sin(second), outer * math.cos(second)]
    )


def random_rotation_matrix(rand: ArrayLike | None = None) -> Array:
    """The matrix of `random_quaternion`."""
    return quaternion_matrix(random_quaternion(rand))
