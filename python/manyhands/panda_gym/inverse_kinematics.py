"""PyBullet's inverse kinematics: heavily damped least squares that stop before they arrive."""

import numpy as np

from manyhands._core import Model, dynamics
from manyhands.panda_gym import rotations
from manyhands.panda_gym.rotations import Array

ITERATIONS = 20
NEAR_ENOUGH = 1e-4
"""The error of the position that an update must start from to be the last [m]."""

_DAMPING = 0.5 * np.eye(6)


def improve(
    model: Model, q: Array, joints: list[tuple[int, int]], link: str, position: Array, quaternion: Array
) -> Array:
    """The configuration (nq) after at most 20 updates dq = J^T (J J^T + 0.5 1)^-1 e from q, with no regard of limits.

    position (3) [m], quaternion (4): where the frame of `link` should be. joints: the places in q and v of those that
    move. The updates equal (J^T J + 0.5 1)^-1 J^T e, with a smaller matrix.
    """
    q = q.copy()
    iq, iv = np.array(joints).T
    for _ in range(ITERATIONS):
        p, r = dynamics.frame_pose(model, q, link)
        error = np.array(rotations.rotation_between(r, quaternion) + (position - p).tolist())
        J = dynamics.jacobian(model, q, link)[:, iv]
        q[iq] += J.T @ np.linalg.solve(J @ J.T + _DAMPING, error)
        if error[3:] @ error[3:] <= NEAR_ENOUGH**2:
            break
    return q
