"""Joints by hand, and what is measured of them."""

import numpy as np
import pytest
from viewed import READY, falling_ball, panda, ready

import manyhands as mh
from manyhands.measures import chain, contact_forces, hand_of, joint_forces
from manyhands.viewer.joints import JointDrive
from manyhands.viewer.robot_panel import labels


def test_the_hand_is_found() -> None:
    model = panda().model
    assert hand_of(model) == "panda_grasptarget"
    assert len(chain(model, "panda_grasptarget")) == 7
    assert hand_of(falling_ball().model) is None


def test_motors_bring_joints_to_their_targets_and_hold_the_others() -> None:
    world = panda()
    drive = ready(world)
    assert not world.v.any()
    drive.move({"panda_joint1": 0.5})
    world.step(1000)
    assert drive.value(drive.knobs[0]) == pytest.approx(0.5, abs=2e-3)
    assert np.abs(world.q[1:7] - READY[1:7]).max() < 5e-3
    with pytest.raises(KeyError):
        drive.move({"nothing": 1.0})


def test_fingers_move_together() -> None:
    world = panda()
    drive = ready(world)
    drive.grip(1.0)
    assert drive.opening == 1.0
    world.step(500)
    assert np.allclose(world.q[7:9], 0.04, atol=1e-3)
    drive.move({"panda_finger_joint1": 0.01})
    assert drive.target("panda_finger_joint2") == pytest.approx(0.01)


def test_the_hand_reaches_a_pose_that_is_dragged() -> None:
    world = panda()
    drive = ready(world)
    position, quaternion = world.body_pose("panda_grasptarget")
    wanted = position + np.array([0.05, -0.1, 0.08])
    assert drive.reach("panda_grasptarget", wanted, quaternion, place=True)
    assert np.allclose(world.body_pose("panda_grasptarget")[0], wanted, atol=1e-4)
    assert not drive.reach("panda_grasptarget", np.array([3.0, 0, 0]), quaternion)


def test_sliders_leave_out_the_name_that_all_joints_share() -> None:
    for names, words in (
        (["panda_joint1", "panda_finger_joint1"], ["joint1", "finger joint1"]),
        (["arm6_joint1", "arm6_joint2"], ["joint1", "joint2"]),
        (["joint_1", "joint_2"], ["joint 1", "joint 2"]),
        (["left/shoulder_pan", "left/elbow"], ["shoulder pan", "elbow"]),
        (["door_hinge"], ["door hinge"]),
        ([], []),
    ):
        assert labels(names) == words


def test_position_actuators_are_told_by_ctrl() -> None:
    model, _ = (
        mh.load_mjcf_string("""<mujoco><worldbody><body><joint name="j" type="hinge" axis="0 0 1" range="-90 90"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0"/></body></worldbody>
      <actuator><position name="a" joint="j" kp="20" kv="2" gear="2"/></actuator></mujoco>""")
    )
    world = mh.World(model)
    drive = JointDrive(world)
    drive.move({"j": 0.4})
    assert world.ctrl[0] == pytest.approx(0.8)
    world.step(3000)
    assert world.q[0] == pytest.approx(0.4, abs=1e-2)


def test_measured_joint_forces_carry_the_arm() -> None:
    world = panda()
    ready(world)
    world.step(1500)
    weight = mh.dynamics.rnea(world.model, world.q, np.zeros(world.model.nv), np.zeros(world.model.nv))
    assert np.allclose(joint_forces(world)[:7], weight[:7], atol=0.05)


def test_contact_forces_are_the_weight() -> None:
    world = falling_ball()
    world.set_body_pose("ball", [0, 0, 0.05])
    world.step(300)
    assert contact_forces(world)["ball"] == pytest.approx(0.2 * 9.81, rel=1e-3)
