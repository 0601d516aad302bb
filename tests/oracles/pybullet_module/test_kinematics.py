"""Inverse kinematics step by step, Jacobians, mass matrices and inverse dynamics of random states."""

import math

import numpy as np
import pytest
from bodies import ARM, add_arm, place, pose

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(5))
NEAR = {
    "lowerLimits": [-2.9, -2, -2.9, -2, -2.9, -2, -3],
    "upperLimits": [2.9, 2, 2.9, 2, 2.9, 2, 3],
    "jointRanges": [5.8, 4, 5.8, 4, 5.8, 4, 6],
    "restPoses": [0, 0, 0, 0.5 * math.pi, 0, -math.pi * 0.5 * 0.66, 0],
}


def target(rng: np.random.Generator) -> list[float]:
    return [rng.uniform(0.3, 0.6), rng.uniform(-0.3, 0.3), rng.uniform(0.3, 0.8)]


@seeds
@pytest.mark.parametrize("turned", [False, True])
def test_inverse_kinematics(both: Beside, rng: np.random.Generator, turned: bool) -> None:
    arm = add_arm(both, rng)
    where = {"targetPosition": target(rng)} | ({"targetOrientation": place(rng)[1]} if turned else {})
    for iterations in (1, 3, 10):
        steps = {"maxNumIterations": iterations}
        both.calculateInverseKinematics(arm, 6, **where, **steps, within=1e-5)
        both.calculateInverseKinematics(arm, 6, **where, **steps, jointDamping=[0.1] * 7, within=1e-5)
        both.calculateInverseKinematics(arm, 6, **where, **steps, residualThreshold=0.05, within=1e-5)
        both.calculateInverseKinematics(arm, 6, **where, **steps, solver=both.IK_DLS, within=1e-5)
        both.calculateInverseKinematics(arm, 6, **where, **steps, **NEAR, within=1e-4)
    both.calculateInverseKinematics(arm, 3, **where, maxNumIterations=2, within=1e-5)
    both.calculateInverseKinematics(
        bodyUniqueId=arm, endEffectorLinkIndex=6, **where, currentPositions=pose(rng), maxNumIterations=2, within=1e-5
    )
    both.calculateInverseKinematics(arm, 6, **where, lowerLimits=[0], maxNumIterations=1, within=1e-5)


@seeds
def test_an_arm(both: Beside, rng: np.random.Generator) -> None:
    arm = add_arm(both, rng)
    q, v, a = pose(rng), pose(rng), pose(rng)
    both.calculateMassMatrix(arm, q, within=1e-5)
    both.calculateMassMatrix(bodyUniqueId=arm, objPositions=q, flags=0, within=1e-5)
    both.calculateInverseDynamics(arm, q, v, a, within=1e-5)
    both.calculateInverseDynamics(bodyUniqueId=arm, objPositions=q, objVelocities=v, objAccelerations=a, within=1e-5)
    for link in (0, 3, 6):
        both.calculateJacobian(arm, link, place(rng, 0.1)[0], q, v, a, within=1e-5)
    both.calculateJacobian(
        bodyUniqueId=arm,
        linkIndex=6,
        localPosition=[0, 0, 0],
        objPositions=q,
        objVelocities=v,
        objAccelerations=a,
        within=1e-5,
    )


@seeds
def test_a_hand_with_fixed_links(both: Beside, rng: np.random.Generator) -> None:
    hand = both.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
    both.setGravity(0, 0, -9.81)
    q = [*pose(rng), 0.02, 0.01]
    both.calculateMassMatrix(hand, q, within=1e-5)
    both.calculateInverseDynamics(hand, q, q, q, within=1e-4)
    both.calculateJacobian(hand, 11, [0, 0, 0], q, q, q, within=1e-5)
    both.calculateInverseKinematics(hand, 11, target(rng), maxNumIterations=3, within=1e-5)


@seeds
def test_a_free_arm(both: Beside, rng: np.random.Generator) -> None:
    arm = both.loadURDF("franka_panda/panda.urdf", *place(rng))
    q = [*pose(rng), 0.02, 0.01]
    both.calculateMassMatrix(arm, q, within=1e-4)
    both.calculateJacobian(arm, 8, [0, 0, 0], q, q, q, within=1e-4)


@pytest.mark.parametrize(
    "call",
    [
        ("calculateInverseKinematics", 9, 0, [0, 0, 0]),
        ("calculateInverseKinematics", 0, 99, [0, 0, 0]),
        ("calculateInverseKinematics", 0, 6, [0, 0]),
        ("calculateInverseKinematics", 0, 6),
        ("calculateInverseKinematics", 0, 6, [0, 0, 0], {"currentPositions": [0]}),
        ("calculateJacobian", 0, 6, [0, 0, 0], [0] * 3, [0] * 7, [0] * 7),
        ("calculateJacobian", 0, 6, [0, 0, 0], [0] * 7),
        ("calculateMassMatrix", 0),
    ],
    ids=str,
)
def test_wrong_kinematics(both: Beside, call: tuple[object, ...]) -> None:
    both.loadURDF(ARM, useFixedBase=True)
    options = call[-1] if isinstance(call[-1], dict) else {}
    both.refuses(*(x for x in call if not isinstance(x, dict)), **options)
