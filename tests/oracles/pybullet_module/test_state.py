"""Poses and velocities of bases, joints and links: set and read, at rest and after steps in free space."""

import numpy as np
import pytest
from bodies import ARM, DOFS, add_arm, add_box, place, random_chain, set_free, solve_to_the_end

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(6))


@seeds
def test_bases(both: Beside, rng: np.random.Generator) -> None:
    body = random_chain(both, rng, 3)
    for _ in range(5):
        both.resetBaseVelocity(body, linearVelocity=rng.normal(size=3).tolist())
        both.getBaseVelocity(body)
        both.resetBaseVelocity(body, angularVelocity=rng.normal(size=3).tolist())
        both.getBaseVelocity(body)
        both.resetBasePositionAndOrientation(body, *place(rng))
        both.getBasePositionAndOrientation(body)
        both.getBaseVelocity(body)
        both.resetBaseVelocity(body, rng.normal(size=3).tolist(), rng.normal(size=3).tolist())
        both.getBaseVelocity(body)
    both.resetBasePositionAndOrientation(body, [1, 2, 3], [0, 0, 0, 3])
    both.getBasePositionAndOrientation(body)
    both.resetBasePositionAndOrientation(99, *place(rng))
    both.resetBaseVelocity(99, [1, 2, 3])
    both.getNumBodies()


@seeds
def test_joints(both: Beside, rng: np.random.Generator) -> None:
    arm = add_arm(both, rng)
    for _ in range(5):
        for joint in DOFS:
            both.resetJointState(arm, joint, targetValue=rng.uniform(-1, 1), targetVelocity=rng.normal())
        both.resetJointStateMultiDof(arm, 2, targetValue=[0.3], targetVelocity=[0.1])
        both.resetJointStatesMultiDof(arm, [3, 4], targetValues=[[0.1], [0.2]], targetVelocities=[[0.3], [0.4]])
        both.getJointStates(arm, DOFS)
        both.getJointStates(bodyUniqueId=arm, jointIndices=np.array([3, 1]))
        both.getJointStatesMultiDof(arm, [0, 5])
        for joint in DOFS:
            both.getJointState(bodyUniqueId=arm, jointIndex=joint)
            both.getJointStateMultiDof(arm, joint)
            both.getLinkState(arm, joint, computeLinkVelocity=1, within=1e-5)
        both.getLinkStates(arm, [6, 2], computeLinkVelocity=1, computeForwardKinematics=1, within=1e-5)
        both.getLinkStates(bodyUniqueId=arm, linkIndices=[0])


@seeds
def test_a_spherical_joint(both: Beside, rng: np.random.Generator) -> None:
    body = both.loadURDF("spherical_joint_limit.urdf", useFixedBase=1)
    q = place(rng)[1]
    for joint in range(both.getNumJoints(body)):
        if both.getJointInfo(body, joint, within=1e-5)[2] != both.JOINT_SPHERICAL:
            continue
        both.resetJointStateMultiDof(body, joint, q, [0.1, 0.2, 0.3])
        both.getJointStateMultiDof(body, joint)
        both.getLinkState(body, joint, within=1e-5)


@seeds
def test_trees_fall_alike(both: Beside, rng: np.random.Generator) -> None:
    solve_to_the_end(both)
    both.setGravity(0.5, -1, -9.81)
    body = random_chain(both, rng, 4)
    joints = range(4)
    set_free(both, body, joints)
    for joint in joints:
        both.resetJointState(body, joint, rng.uniform(-0.5, 0.5), rng.normal())
    both.resetBaseVelocity(body, rng.normal(size=3).tolist(), rng.normal(size=3).tolist())
    for _ in range(10):
        both.stepSimulation()
        both.getBasePositionAndOrientation(body, within=1e-3)
        both.getBaseVelocity(body, within=1e-2)
        both.getJointStates(body, joints, view=lambda states: [state[:2] for state in states], within=1e-2)


@seeds
@pytest.mark.parametrize("parts", [0, 4])
def test_damping_and_time(both: Beside, rng: np.random.Generator, parts: int) -> None:
    both.setTimeStep(0.002)
    both.setPhysicsEngineParameter(numSubSteps=parts)
    body = add_box(both, [0, 0, 1])
    both.changeDynamics(body, -1, linearDamping=rng.uniform(0, 0.5), angularDamping=rng.uniform(0, 0.5))
    both.resetBaseVelocity(body, rng.normal(size=3).tolist(), rng.normal(size=3).tolist())
    for _ in range(20):
        both.stepSimulation()
        both.getBaseVelocity(body, within=1e-4)
        both.getBasePositionAndOrientation(body, within=1e-3)
    both.getPhysicsEngineParameters()


@seeds
def test_saved_states(both: Beside, rng: np.random.Generator) -> None:
    arm, box = add_arm(both, rng), add_box(both, [1, 0, 1])
    first = both.saveState()
    both.step(5)
    second = both.saveState()
    both.step(5)
    for state in (first, second):
        both.restoreState(stateId=state)
        both.getBasePositionAndOrientation(box, within=1e-3)
        both.getJointStates(arm, DOFS, view=lambda states: [state[0] for state in states], within=1e-4)
    both.removeState(stateUniqueId=first)
    both.saveState()
    both.getNumBodies()
    both.refuses("restoreState", 77)
    both.refuses("restoreState", fileName="missing.bullet")


@pytest.mark.parametrize(
    "call",
    [
        ("getJointState", 0, 99),
        ("getJointState", 9, 0),
        ("getJointState", 0, 0.0),
        ("getJointState", 0),
        ("getJointStates", 0, [99]),
        ("getJointStates", 9, [0]),
        ("getLinkState", 0, -1),
        ("getLinkState", 9, 0),
        ("getLinkState", 0, "hand"),
        ("getBasePositionAndOrientation", 9),
        ("getBaseVelocity", 9),
        ("getAABB", 9),
        ("resetJointState", 0, 99, 0),
        ("resetJointState", 9, 0, 0),
        ("resetJointState", 0, 0, "a"),
        ("resetBaseVelocity", 0),
        ("resetBasePositionAndOrientation", 0, [0, 0, 0]),
        ("resetBasePositionAndOrientation", 0, [0, 0], [0, 0, 0, 1]),
        ("resetBasePositionAndOrientation", 0, [0, 0, 0], [0, 0, 1]),
        ("getNumJoints",),
        ("setGravity", [0, 0, -9.81]),
        ("setGravity", 0, 0),
        ("setTimeStep", "fast"),
        ("stepSimulation", 77),
        ("getBodyUniqueId", "a"),
        ("removeBody",),
    ],
    ids=str,
)
def test_wrong_calls(both: Beside, call: tuple[object, ...]) -> None:
    both.loadURDF(ARM, useFixedBase=True)
    both.refuses(*call)


def test_what_is_not_there(both: Beside) -> None:
    both.loadURDF(ARM, useFixedBase=True)
    both.getLinkState(0, 99)
    both.getJointStates(0, [])
    both.removeBody(99)
    both.getNumBodies()


@seeds
def test_boxes_around_links(both: Beside, rng: np.random.Generator) -> None:
    """Of hulls as they lie in the file: Bullet's box of a turned one is that of its box."""
    half, where = rng.uniform(0.1, 0.3, 3).tolist(), place(rng)
    body = both.createMultiBody(1, both.createCollisionShape(both.GEOM_BOX, halfExtents=half), -1, *where)
    both.getAABB(body, within=6e-3)
    both.getAABB(body, linkIndex=-1, within=6e-3)
    arm = both.loadURDF(ARM, where[0])
    for link in range(-1, 7):
        both.getAABB(bodyUniqueId=arm, linkIndex=link, within=6e-3)
