"""Constraints of every kind that multibodies take: how they pull, and what is told of them."""

import numpy as np
import pytest
from bodies import add_box

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(3))


def follow(both: Beside, bodies: list[int], steps: int = 30, within: float = 6e-3) -> None:
    for _ in range(steps):
        both.stepSimulation()
        for body in bodies:
            both.getBasePositionAndOrientation(body, view=lambda X: X[0], within=within)


@seeds
def test_a_weld_to_the_world(both: Beside, rng: np.random.Generator) -> None:
    both.setGravity(0, 0, -9.81)
    box = add_box(both, [0, 0, 1])
    target = (np.array([0, 0, 1]) + rng.uniform(-0.02, 0.02, 3)).tolist()
    weld = both.createConstraint(box, -1, -1, -1, both.JOINT_FIXED, [0, 0, 0], [0, 0, 0], target)
    both.getConstraintInfo(weld)
    follow(both, [box])
    both.changeConstraint(weld, jointChildPivot=[0.1, 0, 1], maxForce=200)
    both.getConstraintInfo(constraintUniqueId=weld)
    both.step(60)
    both.getBasePositionAndOrientation(box, view=lambda X: X[0], within=1e-2)
    turn = both.getQuaternionFromEuler([0, 0, 0.2])
    both.changeConstraint(userConstraintUniqueId=weld, jointChildFrameOrientation=turn)
    both.step(40)
    both.getBasePositionAndOrientation(box, within=2e-2)
    both.removeConstraint(userConstraintUniqueId=weld)
    both.getNumConstraints()


@seeds
def test_two_bodies(both: Beside, rng: np.random.Generator) -> None:
    a, b = add_box(both, [0, 0, 0]), add_box(both, [0.5, 0, 0])
    turn = both.getQuaternionFromEuler((0.1 * rng.normal(size=3)).tolist())
    weld = both.createConstraint(
        parentBodyUniqueId=a,
        parentLinkIndex=-1,
        childBodyUniqueId=b,
        childLinkIndex=-1,
        jointType=both.JOINT_FIXED,
        jointAxis=[0, 0, 0],
        parentFramePosition=[0.24, 0, 0],
        childFramePosition=[-0.24, 0, 0],
        parentFrameOrientation=turn,
        childFrameOrientation=turn,
    )
    both.getConstraintInfo(weld)
    follow(both, [a, b])


@seeds
def test_a_point(both: Beside, rng: np.random.Generator) -> None:
    box = add_box(both, [0, 0, 1])
    corner = [0.1, 0.1, 0.1]
    point = both.createConstraint(box, -1, -1, -1, both.JOINT_POINT2POINT, [0, 0, 0], corner, [0.12, 0.1, 1.1])
    both.getConstraintInfo(point)
    follow(both, [box])


@seeds
def test_a_slide(both: Beside, rng: np.random.Generator) -> None:
    box = add_box(both, [0, 0, 1])
    axis = [[1, 0, 0], [0, 1, 0], [0, 0, 1]][rng.integers(3)]
    slide = both.createConstraint(box, -1, -1, -1, both.JOINT_PRISMATIC, axis, [0, 0, 0], [0, 0, 1])
    both.getConstraintInfo(slide)
    both.resetBaseVelocity(box, [0.2 * x for x in axis])
    follow(both, [box])


@seeds
@pytest.mark.parametrize("options", [{}, {"erp": 0.1}, {"erp": 0.1, "relativePositionTarget": 0.005}], ids=str)
def test_a_gear(both: Beside, rng: np.random.Generator, options: dict[str, float]) -> None:
    hand = both.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
    gear = both.createConstraint(hand, 9, hand, 10, both.JOINT_GEAR, [1, 0, 0], [0, 0, 0], [0, 0, 0])
    both.changeConstraint(gear, gearRatio=-1, maxForce=50, gearAuxLink=-1, **options)
    both.getConstraintInfo(gear)
    both.setJointMotorControl2(hand, 9, both.POSITION_CONTROL, targetPosition=rng.uniform(0.01, 0.04), force=20)
    both.setJointMotorControl2(hand, 10, both.VELOCITY_CONTROL, force=0)
    both.step(120)
    both.getJointStates(hand, [9, 10], view=lambda states: [state[0] for state in states], within=2e-3)


def test_numbers(both: Beside) -> None:
    a, b = add_box(both, [0, 0, 0]), add_box(both, [1, 0, 0])
    made = [both.createConstraint(a, -1, b, -1, both.JOINT_POINT2POINT, [0, 0, 0], *place_of(i)) for i in range(4)]
    both.removeConstraint(made[1])
    for i in range(5):
        both.getConstraintUniqueId(serialIndex=i)
    both.removeConstraint(99)
    both.changeConstraint(99, maxForce=1)
    both.getNumConstraints()
    both.removeBody(b)
    both.getNumConstraints()
    both.createConstraint(a, -1, 77, -1, both.JOINT_FIXED, [0, 0, 0], [0, 0, 0], [0, 0, 0])
    both.getConstraintUniqueId(0)


def place_of(i: int) -> tuple[list[float], list[float]]:
    return [0.1 * i, 0, 0], [0, 0.1 * i, 0]


@pytest.mark.parametrize(
    "call",
    [
        ("createConstraint", 0, -1, -1, -1, 2, [0, 0, 0], [0, 0, 0], [0, 0, 0]),
        ("createConstraint", 0, -1, -1, -1, 4, [0, 0, 0]),
        ("createConstraint", 0, -1, -1, -1, "fixed", [0, 0, 0], [0, 0, 0], [0, 0, 0]),
        ("getConstraintInfo", 9),
        ("removeConstraint",),
        ("changeConstraint", "a"),
    ],
    ids=str,
)
def test_wrong_constraints(both: Beside, call: tuple[object, ...]) -> None:
    add_box(both, [0, 0, 1])
    both.refuses(*call)
