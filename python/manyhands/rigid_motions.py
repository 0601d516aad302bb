"""Rotations and rigid motions: exponential and logarithm maps, adjoints, and poses as matrices.

A pose is a position (..., 3) [m] and a quaternion xyzw (..., 4), a twist (..., 6) the angular part, then the linear
one. Arrays may have any dimensions in front, equal ones where a function takes two; quaternions are normalised. Wrong
shapes, numbers that are not finite, and quaternions without a direction raise ValueError.

Lynch, Park: Modern Robotics, 2017, chapter 3, which names the maps so; manyhands/math/rigid_motion.h.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import kinematics as _core
from manyhands.arguments import finite_rows

__all__ = ["ad", "adjoint", "exp3", "exp6", "log3", "log6", "matrix", "pose"]

Array = NDArray[np.float64]

_SHORTEST_QUATERNION = 1e-6
_LARGEST_SKEW = 1e-6


def unit_quaternions(name: str, values: ArrayLike) -> Array:
    """Values as quaternions (..., 4) of any length that leaves no direction open."""
    quaternions = finite_rows(name, values, 4)
    if _shortest(quaternions) < _SHORTEST_QUATERNION:
        raise ValueError(f"a {name} is shorter than {_SHORTEST_QUATERNION:g}, which leaves its direction open")
    return quaternions


def _shortest(quaternions: Array) -> float:
    """The least length of quaternions (..., 4); a single one, as most are, without numpy's detours."""
    if quaternions.ndim == 1:
        return math.hypot(*quaternions.tolist())
    return float(np.linalg.norm(quaternions, axis=-1).min(initial=np.inf))


def _poses(position: ArrayLike, quaternion: ArrayLike) -> tuple[Array, Array]:
    p, r = finite_rows("position", position, 3), unit_quaternions("quaternion", quaternion)
    if p.shape[:-1] != r.shape[:-1]:
        raise ValueError(f"position has shape {p.shape} and quaternion {r.shape}; expected as many rows")
    return p, r


def _flat(array: Array) -> Array:
    return np.ascontiguousarray(array.reshape(-1, array.shape[-1]))


def _like(given: Array, found: Any) -> Array:
    """Rows that were found, with the dimensions that those given have in front."""
    return found.reshape(given.shape[:-1] + found.shape[1:])


def exp3(rotation: ArrayLike) -> Array:
    """The quaternion (..., 4) of the turn by |rotation| about rotation (..., 3) [rad]."""
    r = finite_rows("rotation", rotation, 3)
    return _like(r, _core.exp3(_flat(r)))


def log3(quaternion: ArrayLike) -> Array:
    """The rotation vector (..., 3) of at most pi [rad] of a quaternion (..., 4)."""
    r = unit_quaternions("quaternion", quaternion)
    return _like(r, _core.log3(_flat(r)))


def exp6(twist: ArrayLike) -> tuple[Array, Array]:
    """The pose that a unit of time of a constant twist (..., 6) [rad, m] leads to: position, quaternion."""
    m = finite_rows("twist", twist, 6)
    position, quaternion = _core.exp6(_flat(m))
    return _like(m, position), _like(m, quaternion)


def log6(position: ArrayLike, quaternion: ArrayLike) -> Array:
    """The twist (..., 6) [rad, m] of the shortest turn, at most pi, that leads to a pose."""
    p, r = _poses(position, quaternion)
    return _like(p, _core.log6(_flat(p), _flat(r)))


def adjoint(position: ArrayLike, quaternion: ArrayLike, *, inverse: bool = False) -> Array:
    """The matrix (..., 6, 6) that takes motions (angular, linear) in the axes and about the origin of B to those of A,
    where the pose is that of B in A; with `inverse` those of A to B. Forces go back by its transpose."""
    p, r = _poses(position, quaternion)
    Ad: Any = _core.adjoint(_flat(p), _flat(r))
    if inverse:
        rotation = Ad[:, :3, :3].swapaxes(1, 2).copy()
        Ad[:, :3, :3] = Ad[:, 3:, 3:] = rotation
        Ad[:, 3:, :3] = Ad[:, 3:, :3].swapaxes(1, 2).copy()
    return _like(p, Ad)


def ad(twist: ArrayLike) -> Array:
    """The matrix (..., 6, 6) of the Lie bracket: ad(a) @ b is the rate at which a motion b changes, carried by a."""
    m = finite_rows("twist", twist, 6)
    return _like(m, _core.bracket(_flat(m)))


def matrix(position: ArrayLike, quaternion: ArrayLike) -> Array:
    """A pose as a homogeneous matrix (..., 4, 4)."""
    p, r = _poses(position, quaternion)
    T = np.zeros((*p.shape[:-1], 4, 4))
    T[..., :3, :3] = adjoint(p, r)[..., :3, :3]
    T[..., :3, 3] = p
    T[..., 3, 3] = 1.0
    return T


def pose(T: ArrayLike) -> tuple[Array, Array]:
    """Position and quaternion of a homogeneous matrix (..., 4, 4). Raises ValueError where it is no rigid motion."""
    M = rigid_matrices("T", T)
    found: Any = _core.quaternions(np.ascontiguousarray(M[..., :3, :3].reshape(-1, 9)))
    return M[..., :3, 3].copy(), found.reshape(*M.shape[:-2], 4)


def rigid_matrices(name: str, values: ArrayLike) -> Array:
    """Values as homogeneous matrices (..., 4, 4) of rigid motions. Raises ValueError on others."""
    M = finite_rows(name, values, 4, 4)
    R = M[..., :3, :3]
    skew = np.abs(R @ R.swapaxes(-1, -2) - np.eye(3)).max(initial=0.0)
    last = np.abs(M[..., 3, :] - [0.0, 0.0, 0.0, 1.0]).max(initial=0.0)
    if skew > _LARGEST_SKEW or last > _LARGEST_SKEW or (np.linalg.det(R) < 0).any():
        raise ValueError(f"{name} is no rigid motion; expected a rotation, a position, and 0 0 0 1 as the last row")
    return M
