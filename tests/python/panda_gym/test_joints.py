"""panda_gym.pybullet.PyBullet moves the links and joints of a robot as panda-gym does."""

import math

import numpy as np
import pytest

import manyhands as mh  # noqa: F401  registers its own environments first
from manyhands.panda_gym.pybullet import PyBullet

IDENTITY = [0.0, 0.0, 0.0, 1.0]
DOWN = [1.0, 0.0, 0.0, 0.0]


@pytest.fixture
def panda() -> PyBullet:
    sim = PyBullet()
    sim.loadURDF(body_name="panda", fileName="franka_panda/panda.urdf", basePosition=[0.0, 0.0, 0.0], useFixedBase=True)
    return sim


def test_links_are_observed_at_their_centres_of_mass(panda: PyBullet) -> None:
    np.testing.assert_allclose(panda.get_link_position("panda", 1), [0.0, 0.060, 0.373], atol=1e-3)
    np.testing.assert_allclose(panda.get_base_position("panda"), [0, 0, 0.05], atol=1e-12)
    np.testing.assert_allclose(panda.get_link_position("panda", 0), [0, -0.04, 0.283], atol=1e-6)


def test_a_joint_is_driven_as_in_panda_gym(panda: PyBullet) -> None:
    panda.control_joints("panda", [5], [0.3], [5.0])
    panda.step()
    assert panda.get_joint_angle("panda", 5) == pytest.approx(0.063, abs=1e-3)
    # Bullet's air slows an arm's links too: 4e-3 of 2.969.
    assert panda.get_joint_velocity("panda", 5) == pytest.approx(2.969, abs=5e-3)
    np.testing.assert_allclose(panda.get_link_velocity("panda", 5), [-0.0068, 0, 0.1186], atol=1e-3)
    np.testing.assert_allclose(panda.get_link_angular_velocity("panda", 5), [0, -2.969, 0], atol=5e-3)
    # Theirs is read one time step late, at 2.97 rad/s.
    turn = 2 * math.atan2(*panda.get_link_orientation("panda", 5)[[1, 0]])
    assert turn == pytest.approx(2 * math.atan2(-0.02, 0.707), abs=8e-3)


def test_joints_that_are_not_driven_stay(panda: PyBullet) -> None:
    joints = [0, 1, 2, 3, 4, 5, 6]
    angles = [0.2, 0.4, -0.3, -1.8, 0.1, 2.0, 0.7]
    panda.set_joint_angles("panda", joints, angles)
    for _ in range(25):
        panda.step()
    np.testing.assert_allclose([panda.get_joint_angle("panda", joint) for joint in joints], angles, atol=1e-5)


def test_a_motor_takes_a_tenth_of_the_way_in_each_time_step(panda: PyBullet) -> None:
    joints = list(range(7))
    panda.set_joint_angles("panda", joints, [0.0, 0.4, 0.0, -1.8, 0.0, 2.2, 0.8])
    panda.control_joints("panda", joints, [0.001, 0.401, 0.001, -1.799, 0.001, 2.201, 0.801], [1000.0] * 7)
    panda.step()
    left = 0.001 * 0.9**20
    np.testing.assert_allclose(panda.get_joint_angle("panda", 3), -1.799 - left, atol=1e-6)
    np.testing.assert_allclose(panda.get_joint_angle("panda", 0), 0.001 - left, atol=1e-6)


def test_joints_are_teleported(panda: PyBullet) -> None:
    panda.control_joints("panda", np.array([3]), np.array([-1.0]), np.array([80.0]))
    panda.step()
    panda.set_joint_angle("panda", 3, angle=0.4)
    assert (panda.get_joint_angle("panda", 3), panda.get_joint_velocity("panda", 3)) == (0.4, 0.0)
    panda.set_joint_angles("panda", joints=np.array([3, 4, 5]), angles=[0.4, 0.5])
    assert panda.get_joint_angle("panda", 4) == 0.5
    assert panda.get_joint_angle("panda", 7) == 0.0  # it is fixed


def test_inverse_kinematics_stops_where_panda_gyms_does(panda: PyBullet) -> None:
    joints = panda.inverse_kinematics("panda", 6, [0.4, 0.5, 0.6], [0.707, -0.02, 0.02, 0.707])
    expected = [1.000, 1.223, -1.113, -0.021, -0.917, 0.666, -0.499, 0.0, 0.0]
    np.testing.assert_allclose(joints, expected, atol=1e-3)
    exactly = [1.00024179, 1.2225676, -1.11318084, -0.02062373, -0.9172826, 0.66635039, -0.4990549, 0.0, 0.0]
    np.testing.assert_allclose(joints, exactly, atol=1e-7)  # PyBullet's
    assert panda.get_joint_angle("panda", 0) == 0.0


NEUTRAL = (0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.0, 0.0)


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        ((0.05, 0, 0), (-0.00060, 0.50923, 0.00070, -1.69633, -0.00042, 2.20993, 0.78566)),
        ((0, 0.05, 0), (0.05848, 0.41371, 0.02124, -1.84447, -0.01091, 2.25825, 0.87019)),
        ((0, 0, 0.05), (-0.00057, 0.33965, 0.00064, -1.82050, -0.00026, 2.16091, 0.78558)),
        ((0, 0, 0), (0.00069, 0.41, 0.00079, -1.85, -0.00082, 2.26, 0.78822)),
    ],
)
@pytest.mark.parametrize("base", [(0.0, 0.0, 0.0), (-0.6, 0.2, 0.1)])
def test_inverse_kinematics_of_a_step(
    panda: PyBullet, step: tuple[float, ...], expected: tuple[float, ...], base: tuple[float, ...]
) -> None:
    panda.set_base_pose("panda", np.add(base, [0, 0, 0.05]), IDENTITY)
    panda.set_joint_angles("panda", [0, 1, 2, 3, 4, 5, 6, 9, 10], NEUTRAL)
    target = panda.get_link_position("panda", 11) + step
    joints = panda.inverse_kinematics("panda", 11, target, DOWN)
    np.testing.assert_allclose(joints, (*expected, 0.0, 0.0), atol=1e-5)


def test_inverse_kinematics_turns_with_the_base(panda: PyBullet) -> None:
    half = math.sqrt(0.5)
    panda.set_joint_angles("panda", [0, 1, 2, 3, 4, 5, 6, 9, 10], NEUTRAL)
    straight = panda.inverse_kinematics("panda", 11, [0.6, 0.1, 0.3], DOWN)
    panda.set_base_pose("panda", [0.0, 0.0, 0.05], [0.0, 0.0, half, half])
    turned = panda.inverse_kinematics("panda", 11, [-0.1, 0.6, 0.3], [half, half, 0.0, 0.0])
    np.testing.assert_allclose(turned, straight, atol=1e-9)


def test_fingers_move_together(panda: PyBullet) -> None:
    for _ in range(5):
        panda.control_joints("panda", [9, 10], [0.03, 0.03], [170.0, 170.0])
        panda.step()
    left, right = panda.get_joint_angle("panda", 9), panda.get_joint_angle("panda", 10)
    assert left == pytest.approx(0.03, abs=1e-3)
    assert right == pytest.approx(left, abs=1e-6)
