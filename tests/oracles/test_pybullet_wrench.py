"""What joints transmit, against PyBullet's force-torque sensors on a Panda that holds still."""

from collections.abc import Iterator

import numpy as np
import pytest

import manyhands as mh

pybullet = pytest.importorskip("pybullet")

URDF = mh.asset_path("panda/panda.urdf")
POSE = [0.3, -0.8, 0.2, -2.0, 0.4, 1.6, 0.8, 0.02, 0.02]
FORCE = 1e4  # enough to hold still


@pytest.fixture
def client() -> Iterator[int]:
    client = pybullet.connect(pybullet.DIRECT)
    yield client
    pybullet.disconnect(client)


def held_in_pybullet(client: int) -> dict[str, np.ndarray]:
    """Force, torque (6) of each joint on its child, about the child's centre of mass, in the child's axes."""
    p, where = pybullet, {"physicsClientId": client}
    p.setGravity(0, 0, -9.81, **where)
    p.setTimeStep(0.002, **where)
    robot = p.loadURDF(str(URDF), useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE, **where)
    joints = range(p.getNumJoints(robot, **where))
    moving = [i for i in joints if p.getJointInfo(robot, i, **where)[2] != p.JOINT_FIXED]
    for i in joints:
        p.enableJointForceTorqueSensor(robot, i, True, **where)
    for i, angle in zip(moving, POSE, strict=True):
        p.resetJointState(robot, i, angle, **where)
        p.setJointMotorControl2(
            robot, i, p.POSITION_CONTROL, targetPosition=angle, positionGain=0.1, force=FORCE, **where
        )
    for _ in range(300):
        p.stepSimulation(**where)
    return {
        p.getJointInfo(robot, i, **where)[1].decode(): np.array(p.getJointState(robot, i, **where)[2]) for i in joints
    }


def test_wrenches_agree_with_pybullet(client: int) -> None:
    theirs = held_in_pybullet(client)
    model, _ = mh.load_urdf(URDF)
    world = mh.World(model)
    world.q = POSE
    world.set_motors(target_q=POSE, kp=0.1, max_force=FORCE)
    world.step(300)
    compared = 0
    for joint in model.joints:
        link = model.links[joint.child]
        # PyBullet leaves out what the joint's own motor carries: along a slide a force, about a hinge a torque.
        if joint.type == "prismatic" or joint.name not in theirs or link.mass == 0:
            continue
        wrench = world.joint_wrench(joint.name)
        x, y, z, w = world.body_pose(link.name)[1]
        R = np.array(pybullet.getMatrixFromQuaternion([x, y, z, w])).reshape(3, 3)
        torque, force = R.T @ wrench[:3], R.T @ wrench[3:]
        torque = torque - np.cross(link.com, force)
        across = np.eye(3) if joint.type == "fixed" else np.eye(3) - np.outer(joint.axis, joint.axis)
        # PyBullet's arm hangs a milliradian below its targets.
        np.testing.assert_allclose(force, theirs[joint.name][:3], atol=0.05, err_msg=joint.name)
        np.testing.assert_allclose(across @ torque, across @ theirs[joint.name][3:], atol=0.05, err_msg=joint.name)
        compared += 1
    assert compared >= 8
