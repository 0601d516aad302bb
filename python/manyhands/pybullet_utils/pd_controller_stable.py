"""Stable PD control: its damping counts with the velocity that the step will end with (Tan, Liu, Turk: Stable
proportional-derivative controllers, 2011).

From M a = p + d - bias with p = kp (q_desired - q) and d = kd (v_desired - v - h a) follows
(M + h kd) a = p + kd (v_desired - v) - bias.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class PDControllerStable:
    """For bodies whose joints have one degree of freedom each.

    `pb` is pybullet or a BulletClient. Rows of numbers are those of jointIndices in order; of a body whose base moves,
    those of the base come first: position (3) and quaternion (4) in desiredPositions, else (6).
    """

    def __init__(self, pb: Any) -> None:
        self._pb = pb

    def computePD(  # noqa: N802  the name it has in pybullet_utils
        self,
        bodyUniqueId: int,
        jointIndices: Sequence[int],
        desiredPositions: ArrayLike,
        desiredVelocities: ArrayLike,
        kps: ArrayLike,
        kds: ArrayLike,
        maxForces: ArrayLike,
        timeStep: float,
    ) -> Array:
        """Forces for TORQUE_CONTROL [N m or N], at most maxForces in size; of a base that moves first six."""
        pb = self._pb
        wanted = np.asarray(desiredPositions, np.float64)
        states = pb.getJointStates(bodyUniqueId, jointIndices)
        q, v = np.array([state[:2] for state in states], np.float64).reshape(-1, 2).T
        error = wanted[-len(q) :] - q if len(q) else q
        if pb.getDynamicsInfo(bodyUniqueId, -1)[0] > 0:
            position, orientation = pb.getBasePositionAndOrientation(bodyUniqueId)
            error = np.concatenate([wanted[:3] - position, np.zeros(3), error])
            q, v = np.concatenate([position, orientation, q]), np.concatenate([np.zeros(6), v])
        q, v = q.tolist(), v.tolist()
        M = np.array(pb.calculateMassMatrix(bodyUniqueId, q))
        bias = np.array(pb.calculateInverseDynamics(bodyUniqueId, q, v, [0.0] * len(v)))
        return _stable(M, bias, error, np.asarray(desiredVelocities) - v, kps, kds, maxForces, timeStep)


class PDControllerStableMultiDof:
    """For bodies with a base that moves and joints of any kind, as humanoids.

    `pb` is pybullet or a BulletClient. Rows of numbers are laid out alike: seven for the base, four for each spherical
    joint, one for each other joint that moves. In a row of positions the base has its position and quaternion, and a
    spherical joint its quaternion; in the others the base has three linear numbers, then three angular ones, and a
    spherical joint three, the last of the seven or four being idle.
    """

    def __init__(self, pb: Any) -> None:
        self._pb = pb

    def computePD(  # noqa: N802  the name it has in pybullet_utils
        self,
        bodyUniqueId: int,
        jointIndices: Sequence[int],
        desiredPositions: ArrayLike,
        desiredVelocities: ArrayLike,
        kps: ArrayLike,
        kds: ArrayLike,
        maxForces: ArrayLike,
        timeStep: float,
    ) -> Array:
        """Forces [N m or N], at most maxForces in size, laid out as desiredVelocities. The base is not turned."""
        pb = self._pb
        wanted = np.asarray(desiredPositions, np.float64)
        position, orientation = pb.getBasePositionAndOrientation(bodyUniqueId)
        linear, angular = pb.getBaseVelocity(bodyUniqueId)
        q, v = [*position, *orientation], [*linear, *angular, 0.0]
        error = [*(wanted[:3] - position), 0.0, 0.0, 0.0, 0.0]
        for state in pb.getJointStatesMultiDof(bodyUniqueId, jointIndices):
            now, rate = state[:2]
            goal = wanted[len(q) : len(q) + len(now)]
            if len(now) == 4:
                error += [*_turn(now, goal), 0.0]
                rate = [*rate[:3], 0.0]
            else:
                error += [*(goal - now)]
            q += now
            v += rate
        M = np.array(pb.calculateMassMatrix(bodyUniqueId, q, flags=1))
        bias = np.array(pb.calculateInverseDynamics(bodyUniqueId, q, v, [0.0] * len(v), flags=1))
        rates = np.asarray(desiredVelocities) - v
        return _stable(M, bias, np.array(error), rates, kps, kds, maxForces, timeStep)


def _stable(
    M: Array, bias: Array, error: Array, error_rate: Array, kps: ArrayLike, kds: ArrayLike, limits: ArrayLike, h: float
) -> Array:
    kp, kd, limit = (np.asarray(numbers, np.float64) for numbers in (kps, kds, limits))
    push = kp * error + kd * error_rate
    acceleration = np.linalg.solve(M + h * np.diag(np.broadcast_to(kd, push.shape)), push - bias)
    return np.clip(push - h * kd * acceleration, -limit, limit)


def _turn(start: Any, end: Any) -> Array:
    """The rotation vector (3) [rad] from one quaternion to another, in the axes of the first, the short way."""
    vector, scalar = np.asarray(start[:3]), start[3]
    turned = scalar * np.asarray(end[:3]) - end[3] * vector - np.cross(vector, end[:3])
    cosine = scalar * end[3] + vector @ end[:3]
    sine = float(np.linalg.norm(turned))
    if sine < 1e-12:
        return np.zeros(3)
    return np.copysign(2 * np.arctan2(sine, abs(cosine)) / sine, cosine) * turned
