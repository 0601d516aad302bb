# ruff: noqa: N802  the names are those of Modern Robotics
"""Rotations, rigid motions and screws by the names of Modern Robotics: arrays in, arrays out, angular part first.

All maps are those of `manyhands.kinematics`, exact near 0 and near a half turn. Wrong shapes raise ValueError.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import kinematics

Array = NDArray[np.float64]

_NEAR_ZERO = 1e-6


def _shaped(name: str, values: ArrayLike, *shape: int) -> Array:
    array = np.asarray(values, np.float64)
    if array.size == int(np.prod(shape)):
        return array.reshape(shape)
    raise ValueError(f"{name} has shape {array.shape}; expected {shape}")


def NearZero(z: float) -> bool:
    """Whether |z| is below 1e-6."""
    return abs(z) < _NEAR_ZERO


def skew_symmetric(v: ArrayLike) -> Array:
    """The matrix (3, 3) of the cross product with v (3,)."""
    x, y, z = _shaped("v", v, 3)
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


VecToso3 = skew_symmetric


def skew_symmetric_to_vector(so3: ArrayLike) -> Array:
    """The vector (3,) of a skew matrix (3, 3)."""
    m = _shaped("the matrix", so3, 3, 3)
    return np.array([m[2, 1], m[0, 2], m[1, 0]])


def MatrixExp3(so3: ArrayLike) -> Array:
    """The rotation (3, 3) of a skew matrix (3, 3)."""
    return _rotation(kinematics.exp3(skew_symmetric_to_vector(so3)))


def MatrixLog3(R: ArrayLike) -> Array:
    """The skew matrix (3, 3) of a rotation (3, 3)."""
    return skew_symmetric(_rotation_vector(R))


def rotation_logm(R: ArrayLike) -> tuple[Array, float]:
    """Axis (3,) and angle in [0, pi] of a rotation (3, 3); the axis is 0 where the angle is below 1e-6."""
    turn = _rotation_vector(R)
    angle = float(np.linalg.norm(turn))
    return (np.zeros(3), 0.0) if angle < _NEAR_ZERO else (turn / angle, angle)


def VecTose3(V: ArrayLike) -> Array:
    """The matrix (4, 4) of a twist (6,)."""
    twist, se3 = _shaped("V", V, 6), np.zeros((4, 4))
    se3[:3, :3], se3[:3, 3] = skew_symmetric(twist[:3]), twist[3:]
    return se3


def se3ToVec(se3: ArrayLike) -> Array:
    """The twist (6,) of its matrix (4, 4)."""
    m = _shaped("the matrix", se3, 4, 4)
    return np.concatenate([skew_symmetric_to_vector(m[:3, :3]), m[:3, 3]])


def MatrixExp6(se3: ArrayLike) -> Array:
    """The rigid motion (4, 4) of a twist's matrix (4, 4)."""
    return kinematics.matrix(*kinematics.exp6(se3ToVec(se3)))


def logm(T: ArrayLike) -> Array:
    """The twist (6,) of a rigid motion (4, 4)."""
    return kinematics.log6(*kinematics.pose(_shaped("T", T, 4, 4)))


def MatrixLog6(T: ArrayLike) -> Array:
    """The twist's matrix (4, 4) of a rigid motion (4, 4)."""
    return VecTose3(logm(T))


def logm_to_twist(logm: ArrayLike) -> Array:
    """The twist (6,) of a matrix (4, 4) as MatrixLog6 gives it."""
    return se3ToVec(logm)


def transform_from_twist(S: ArrayLike, theta: float) -> Array:
    """The rigid motion (4, 4) of turning by theta about the screw axis S (6,)."""
    return kinematics.matrix(*kinematics.exp6(_shaped("S", S, 6) * theta))


def adjoint_transform(T: ArrayLike) -> Array:
    """The matrix (6, 6) that takes twists from the axes of B to those of A, where T is the pose of B in A."""
    return kinematics.adjoint(*kinematics.pose(_shaped("T", T, 4, 4)))


def TransToRp(T: ArrayLike) -> tuple[Array, Array]:
    """Rotation (3, 3) and position (3,) of a rigid motion."""
    m = _shaped("T", T, 4, 4)
    return m[:3, :3], m[:3, 3]


def TransInv(T: ArrayLike) -> Array:
    """The inverse of a rigid motion."""
    R, p = TransToRp(T)
    inverse = np.eye(4)
    inverse[:3, :3], inverse[:3, 3] = R.T, -R.T @ p
    return inverse


def extract_r_list(S_list: ArrayLike | None) -> Array:
    """A point on each screw axis, (n, 3), of axes (6, n); 0 for those that slide."""
    if S_list is None:
        return np.zeros((0, 3))
    S = np.asarray(S_list, np.float64)
    omega, v = S[:3].T, S[3:].T
    length = (omega * omega).sum(1, keepdims=True)
    return np.where(length > _NEAR_ZERO**2, np.cross(omega, v) / np.where(length > _NEAR_ZERO**2, length, 1.0), 0.0)


def extract_omega_list(S_list: ArrayLike | None) -> Array:
    """The angular parts (n, 3) of screw axes, rows (n, 6) or columns (6, n); six of them count as rows."""
    if S_list is None:
        return np.zeros((0, 3))
    S = np.asarray(S_list, np.float64)
    return S[:, :3] if S.shape[1] == 6 else S[:3].T


def extract_screw_list(omega_list: ArrayLike | None, r_list: ArrayLike | None) -> Any:
    """Screw axes (6, n) of joints that turn about omega (3, n) through the points r, (3, n) or (n, 3), or rows of
    three numbers one after the other; one of either goes with all of the other. Points that are empty or None are the
    origin; None without axes."""
    if omega_list is None:
        return None
    omega = _columns("omega_list", omega_list)
    r: Array = np.asarray(np.zeros(3) if r_list is None or np.size(r_list) == 0 else r_list, np.float64)
    r = _columns("r_list", r.T if r.ndim == 2 and r.shape != omega.shape and r.shape[1] == 3 else r)
    if omega.shape[1] != r.shape[1] and 1 not in (omega.shape[1], r.shape[1]):
        raise ValueError(f"there are {omega.shape[1]} axes and {r.shape[1]} points; expected as many, or one")
    omega, r = np.broadcast_arrays(omega, r)
    return np.vstack([omega, -np.cross(omega.T, r.T).T])


def _columns(name: str, values: ArrayLike) -> Array:
    """(3, n) of that, or of (3 n,)."""
    array = np.asarray(values, np.float64)
    array = array.reshape(-1, 3).T if array.ndim == 1 and array.size % 3 == 0 else array
    if array.ndim != 2 or array.shape[0] != 3:
        raise ValueError(f"{name} has shape {np.shape(values)}; expected (3, n)")
    return array


def CubicTimeScaling(Tf: float, t: float) -> float:
    """3 (t / Tf)² - 2 (t / Tf)³: from 0 to 1, at rest at both ends."""
    share = t / Tf
    return share * share * (3 - 2 * share)


def QuinticTimeScaling(Tf: float, t: float) -> float:
    """The same with no acceleration at both ends either."""
    share = t / Tf
    return share**3 * (10 + share * (6 * share - 15))


def rotation_matrix_to_euler_angles(R: ArrayLike) -> Array:
    """(roll, pitch, yaw) [rad] with R = Rz(yaw) Ry(pitch) Rx(roll); yaw is 0 where pitch is a quarter turn."""
    m: Any = _shaped("R", R, 3, 3)
    level = np.hypot(m[0, 0], m[1, 0])
    if level < _NEAR_ZERO:
        return np.array([np.arctan2(-m[1, 2], m[1, 1]), np.arctan2(-m[2, 0], level), 0.0])
    return np.array([np.arctan2(m[2, 1], m[2, 2]), np.arctan2(-m[2, 0], level), np.arctan2(m[1, 0], m[0, 0])])


def euler_to_rotation_matrix(euler_deg: ArrayLike) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll) of (roll, pitch, yaw), which are degrees here."""
    roll, pitch, yaw = np.radians(_shaped("euler_deg", euler_deg, 3))
    turns = [kinematics.exp3(turn) for turn in np.diag([roll, pitch, yaw])]
    Rx, Ry, Rz = (_rotation(turn) for turn in turns)
    return Rz @ Ry @ Rx


def _rotation(quaternion: Array) -> Array:
    return kinematics.matrix(np.zeros(3), quaternion)[:3, :3]


def _rotation_vector(R: ArrayLike) -> Array:
    T = np.eye(4)
    T[:3, :3] = _shaped("R", R, 3, 3)
    return kinematics.log3(kinematics.pose(T)[1])
