"""An arm that is told where its hand is to be."""

import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import manyhands as mh
from manyhands.rotations import conjugate, multiply

DOWN = [1.0, 0.0, 0.0, 0.0]


def table() -> mh.World:
    """An arm with a gripper on the floor, and a cube."""
    world = mh.World()
    world.add_plane("floor")
    world.add(mh.robots.load("six_axis", gripper="parallel"), name="arm")
    world.add_box("cube", [0.02, 0.02, 0.02], mass=0.1, position=[0.5, 0, 0.02])
    return world


def turned_by(a: np.ndarray, b: np.ndarray) -> float:
    """The angle between two orientations [rad]."""
    return 2 * float(np.arcsin(min(1.0, np.linalg.norm(multiply(conjugate(a), b)[:3]))))


def test_a_cube_is_fetched_in_five_lines() -> None:
    world = table()
    arm = mh.robots.Arm(world, "arm/gripper/tool")
    arm.go_to(([0.5, 0, 0.15], DOWN))
    arm.go_to([0.5, 0, 0.02])
    world.move({"arm/gripper/jaw_joint": 0.025})
    world.step(150)
    arm.go_to([0.4, 0.2, 0.3])
    assert np.allclose(world.body_pose("cube")[0], [0.4, 0.2, 0.3], atol=1e-3)
    world.step(500)  # the motors hold
    position, quaternion = arm.pose
    assert np.allclose(position, [0.4, 0.2, 0.3], atol=1e-5)
    assert turned_by(np.asarray(quaternion), np.array(DOWN)) < 1e-4  # as it was turned before


def test_the_way_is_smooth_and_keeps_the_speeds_of_the_joints() -> None:
    world = table()
    arm = mh.robots.Arm(world, "arm/gripper/tool")
    joints = [world.model.joint(name) for name in arm.joints]
    speeds: list[np.ndarray] = []
    arm.go_to(([0.0, 0.5, 0.4], DOWN), on_step=lambda: speeds.append(world.v[[joint.iv for joint in joints]]))
    share = np.abs(speeds) / [joint.velocity for joint in joints]
    assert share.max() == pytest.approx(0.5, abs=0.01)
    assert np.abs(speeds[0]).max() < 0.01 and np.abs(speeds[-1]).max() < 0.01
    before = world.time
    arm.go_to([0.1, 0.5, 0.4], seconds=2.0)
    assert world.time - before == pytest.approx(2.0, abs=1.5 * world.time_step)


def test_what_cannot_be_reached_moves_nothing() -> None:
    world = table()
    arm = mh.robots.Arm(world, "arm/gripper/tool")
    before = world.state_hash()
    with pytest.raises(ValueError, match=r"arm/gripper/tool does not reach \[3.0, 0.0, 0.3\]: the nearest .* mm"):
        arm.go_to([3, 0, 0.3])
    for seconds in (0, -1, np.inf, np.nan):
        with pytest.raises(ValueError, match="seconds is"):
            arm.go_to([0.5, 0, 0.3], seconds=seconds)
    with pytest.raises(ValueError, match="position has shape"):
        arm.go_to([0.5, 0])
    assert world.state_hash() == before


def test_no_pose_is_refused() -> None:
    world = table()
    arm = mh.robots.Arm(world, "arm/gripper/tool")
    before = world.state_hash()
    for pose, message in (
        (None, "position is None"),
        ((None, DOWN), "position is None"),
        (([0.5, 0, 0.3], None), "quat"),
    ):
        with pytest.raises(ValueError, match=message):
            arm.go_to(pose)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"seconds is 1e-06; 'arm/joint\d' needs 0.\d+ s"):
        arm.go_to([0.5, 0, 0.3], seconds=1e-6)
    assert world.state_hash() == before


def test_a_hand_that_does_not_arrive_says_what_is_in_its_way() -> None:
    world = table()
    world.add_box("block", [0.2, 0.2, 0.1], position=[0.5, 0, 0.1], fixed=True)
    arm = mh.robots.Arm(world, "arm/gripper/tool")
    arm.go_to(([0.5, 0, 0.3], DOWN))
    with pytest.raises(RuntimeError, match=r"tool did not arrive: it is \d+ mm and \d+ degrees off; .*'block'.* touch"):
        arm.go_to([0.5, 0, 0.1])
    assert arm.pose[0][2] > 0.15  # it stands where it got to


def test_motors_that_are_too_weak_are_told() -> None:
    world = mh.World(mh.robots.load("six_axis"))
    world.add_box("load", [0.1] * 3, mass=500, position=world.body_pose("flange")[0] + [0, 0, -0.15])
    world.weld("flange", "load")
    with pytest.raises(RuntimeError, match=r"did not arrive: .*; nothing touches it, so its motors are too weak"):
        mh.robots.Arm(world, "flange").go_to([0.4, 0.2, 0.5])


def test_the_hand_is_found_or_named() -> None:
    world = table()
    assert mh.robots.Arm(world).hand == "arm/gripper/tool"
    with pytest.raises(KeyError, match="arm/hand"):
        mh.robots.Arm(world, "arm/hand")
    with pytest.raises(ValueError, match="lead to 'cube'"):
        mh.robots.Arm(world, "cube")
    empty = mh.World()
    empty.add_plane("floor")
    with pytest.raises(ValueError, match="nothing in this world looks like a hand"):
        mh.robots.Arm(empty)


def test_a_second_robot_from_robot_descriptions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The three lines of docs/robots.md. Its modules hold a path to a clone, whose meshes are named by package."""
    clone = tmp_path / "cache" / "arms"
    (clone / "arm_description" / "meshes").mkdir(parents=True)
    (clone / "arm_description" / "package.xml").write_text("<package><name>arm_description</name></package>")
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    mesh = clone / "arm_description" / "meshes" / "link.obj"
    mesh.write_text(f"v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.4\n{faces}")
    inertial = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    shape = '<visual><geometry><mesh filename="package://arm_description/meshes/link.obj"/></geometry></visual>'
    (clone / "arm_description" / "urdf").mkdir()
    urdf = clone / "arm_description" / "urdf" / "arm.urdf"
    urdf.write_text(
        f'<robot name="arm"><link name="base"/><link name="upper">{inertial}{shape}</link>'
        '<joint name="turn" type="continuous"><parent link="base"/><child link="upper"/></joint></robot>'
    )
    descriptions, module = ModuleType("robot_descriptions"), ModuleType("robot_descriptions.arm_description")
    module.URDF_PATH = str(urdf)  # pyright: ignore[reportAttributeAccessIssue]
    descriptions.arm_description = module  # pyright: ignore[reportAttributeAccessIssue]
    monkeypatch.setitem(sys.modules, "robot_descriptions", descriptions)
    monkeypatch.setitem(sys.modules, "robot_descriptions.arm_description", module)
    world = table()

    from robot_descriptions import arm_description  # pyright: ignore[reportMissingImports]

    world.add(arm_description.URDF_PATH, [0, 0.8, 0], name="second")

    assert [mesh for mesh in world.model.meshes if mesh.source.endswith("link.obj")]
    assert "link.obj" not in str(world.report)
    assert {"arm", "second"} <= set(world.names)
