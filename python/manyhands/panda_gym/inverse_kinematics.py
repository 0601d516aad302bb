"""PyBullet's inverse kinematics: heavily damped least squares that stop before they arrive."""

import numpy as np

from manyhands import dynamics
from manyhands._core import Model
from manyhands.panda_gym import rotations
from manyhands.panda_gym.rotations import Array

ITERATIONS = 20
DAMPING = 0.5
NEAR_ENOUGH = 1e-4
"""The error of the position that an update must start from to be the last [m]."""


def improve(
    model: Model, q: Array, joints: list[tuple[int, int]], link: str, position: Array, quaternion: Array
) -> Array:
    """The configuration (nq) after at most 20 updates dq = J^T (J J^T + 0.5 1)^-1 e from q, with no regard of limits.

    position (3) [m], quaternion (4): where the frame of `link` should be. joints: the places in q and v of those that
    move. As PyBullet has it, the error e is that of the link's frame, and J belongs to the link's centre of mass. These
    are the updates (J^T J + 0.5 1)^-1 J^T e, with a smaller matrix.
    """
    q = q.copy()
    iq, iv = [i for i, _ in joints], [i for _, i in joints]
    com = next(other.com for other in model.links if other.name == link)
    for _ in range(ITERATIONS):
        p, r = dynamics.frame_pose(model, q, link)
        turn = rotations.rotation_vector(rotations.multiply(quaternion, rotations.conjugate(r)))
        error = np.concatenate([turn, position - p])
        J = dynamics.jacobian(model, q, link)[:, iv]
        if com.any():
            J[3:] -= np.cross(rotations.rotate(r, com), J[:3].T).T
        q[iq] += J.T @ np.linalg.solve(J @ J.T + DAMPING * np.eye(6), error)
        if error[3:] @ error[3:] <= NEAR_ENOUGH**2:
            break
    return q
