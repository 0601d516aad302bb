"""Quaternions (x, y, z, w) and Euler angles (roll, pitch, yaw): R = Rz(yaw) Ry(pitch) Rx(roll), as in PyBullet."""

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
_UPRIGHT = 0.99999


def as_quaternion(orientation: ArrayLike) -> Array:
    """A unit quaternion (4) of a quaternion of any length above 0, or of Euler angles (3) [rad]."""
    numbers = np.asarray(orientation, np.float64)
    if numbers.shape == (3,):
        return from_euler(numbers)
    length = math.sqrt(float(numbers @ numbers)) if numbers.shape == (4,) else 0.0
    if not 0 < length < math.inf:
        raise ValueError(f"the orientation is {orientation}; expected a quaternion (x, y, z, w) or three Euler angles")
    return numbers / length


def from_euler(angles: ArrayLike) -> Array:
    """The quaternion (4) of Euler angles (3) [rad]."""
    roll, pitch, yaw = (float(angle) / 2 for angle in np.asarray(angles))
    about_x = np.array([math.sin(roll), 0, 0, math.cos(roll)])
    about_y = np.array([0, math.sin(pitch), 0, math.cos(pitch)])
    about_z = np.array([0, 0, math.sin(yaw), math.cos(yaw)])
    return multiply(about_z, multiply(about_y, about_x))


def to_euler(quaternion: ArrayLike) -> Array:
    """Euler angles (3) [rad] of a unit quaternion; upright pitches leave all turning to the yaw."""
    x, y, z, w = (float(c) for c in np.asarray(quaternion))
    sine = 2 * (w * y - x * z)
    if abs(sine) >= _UPRIGHT:
        sign = math.copysign(1.0, sine)
        return np.array([0.0, sign * math.pi / 2, 2 * math.atan2(-sign * x, sign * y)])
    roll = math.atan2(2 * (y * z + w * x), w * w - x * x - y * y + z * z)
    yaw = math.atan2(2 * (x * y + w * z), w * w + x * x - y * y - z * z)
    return np.array([roll, math.asin(sine), yaw])


def multiply(a: Array, b: Array) -> Array:
    """The quaternion of the rotation b, then a."""
    x, y, z, w = a.tolist()
    s, t, u, r = b.tolist()
    return np.array(
        [
            w * s + x * r + y * u - z * t,
            w * t - x * u + y * r + z * s,
            w * u + x * t - y * s + z * r,
            w * r - x * s - y * t - z * u,
        ]
    )


def conjugate(quaternion: Array) -> Array:
    """The inverse of a unit quaternion."""
    return np.array([-1.0, -1.0, -1.0, 1.0]) * quaternion


def rotate(quaternion: Array, vector: Array) -> Array:
    """The vector (3) turned."""
    axis, w = quaternion[:3], float(quaternion[3])
    t = 2 * cross(axis, vector)
    return vector + w * t + cross(axis, t)


def cross(a: Array, b: Array) -> Array:
    """The cross product (3): numpy's takes ten times as long."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
