"""Descriptions that change, and several robots in one scene, against dynamics and geometry."""

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from manyhands.manipulapy import utils
from manyhands.manipulapy.ManipulaPy_data import get_robot_urdf
from manyhands.manipulapy.urdf import URDF, Scene, URDFModifier, load_calibration, save_calibration
from manyhands.manipulapy.urdf_processor import URDFToSerialManipulator, create_multi_robot_scene

Array = NDArray[np.float64]
PENDULUM = """<robot name="pendulum">
  <link name="base"/>
  <link name="arm"><inertial>
    <origin xyz="0 0 0.5" rpy="0.3 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0.01" izz="0.15"/>
  </inertial><collision><origin xyz="0 0 0.5"/>
    <geometry><cylinder radius="0.1" length="1"/></geometry></collision></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 0.5"/><axis xyz="0 2 0"/><limit lower="-3" upper="3" effort="5" velocity="2"/></joint>
  <link name="hand"/>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="0" upper="0.2" effort="5" velocity="2"/></joint>
</robot>"""


@pytest.fixture
def pendulum() -> URDF:
    return URDF.from_xml_string(PENDULUM)


def test_a_copy_changes(pendulum: URDF) -> None:
    modifier = URDFModifier(pendulum)
    changed = modifier.set_link_mass("arm", 3.0).set_link_com("arm", [0.0, 0.1, 0.4]).urdf
    arm, before = changed.get_link("arm"), pendulum.get_link("arm")
    assert before.mass == 2.0 and arm.mass == 3.0
    np.testing.assert_allclose(arm.com, [0.0, 0.1, 0.4])
    np.testing.assert_allclose(arm.inertia, before.inertia, atol=1e-15)
    assert modifier.urdf.get_link("arm").mass == 3.0
    assert modifier.remove_link_inertial("arm").urdf.get_link("arm").mass == 0.0
    assert modifier.set_link_mass("arm", 1.0).urdf.get_link("arm").mass == 1.0


def test_a_payload_is_a_body_that_is_welded_on(pendulum: URDF) -> None:
    mass, com, inertia = 1.5, np.array([0.2, -0.1, 0.9]), np.diag([0.03, 0.02, 0.01])
    loaded = URDFModifier(pendulum).add_payload("arm", mass, com, inertia).urdf
    carried = URDF.from_xml_string(
        PENDULUM.replace(
            "</robot>",
            f"""<link name="load"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}"/><mass value="{mass}"/>
            <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial></link>
            <joint name="weld" type="fixed"><parent link="arm"/><child link="load"/></joint></robot>""",
        )
    )
    for q in ([0.0, 0.0], [0.7, 0.1], [-2.0, 0.2]):
        one, other = (robot.to_manipulator_dynamics("arm") for robot in (loaded, carried))
        np.testing.assert_allclose(one.mass_matrix(q[:1]), other.mass_matrix(q[:1]), atol=1e-12)
        np.testing.assert_allclose(one.gravity_forces(q[:1]), other.gravity_forces(q[:1]), atol=1e-12)
    point = URDFModifier(pendulum).add_payload("arm", 2.0).urdf.get_link("arm")
    np.testing.assert_allclose(point.com, pendulum.get_link("arm").com)
    assert point.mass == 4.0


def test_masses_are_scaled_with_their_inertias(pendulum: URDF) -> None:
    arm = pendulum.get_link("arm")
    scaled = URDFModifier(pendulum).scale_masses(1.5).urdf.get_link("arm")
    assert scaled.mass == 1.5 * arm.mass
    np.testing.assert_allclose(scaled.inertia, 1.5 * arm.inertia, rtol=1e-12)
    assert URDFModifier(pendulum).scale_masses(3.0, ["hand"]).urdf.get_link("arm").mass == arm.mass


def test_a_zero_that_is_offset_is_where_the_joint_was(pendulum: URDF) -> None:
    offset = URDFModifier(pendulum).apply_calibration({"hinge": {"offset": 0.3}, "slide": {"offset": 0.05}}).urdf
    for q in (np.zeros(2), np.array([0.4, 0.1])):
        moved = pendulum.get_transform("hand", cfg=q + np.array([0.3, 0.05]))
        np.testing.assert_allclose(offset.get_transform("hand", cfg=q), moved, atol=1e-12)


def test_joints_change(pendulum: URDF) -> None:
    modifier = URDFModifier(pendulum)
    changed = modifier.set_joint_origin("hinge", rpy=[0.1, 0.2, 0.3]).set_joint_axis("hinge", [3.0, 0.0, 4.0]).urdf
    T = changed.get_transform("arm", cfg=[0.0, 0.0])
    np.testing.assert_allclose(T[:3, 3], [0, 0, 1])
    np.testing.assert_allclose(T[:3, :3], utils.euler_to_rotation_matrix(np.degrees([0.1, 0.2, 0.3])), atol=1e-12)
    np.testing.assert_allclose(changed.get_joint("hinge").axis, [0.6, 0.0, 0.8])
    limited = modifier.set_joint_limits("hinge", lower=-1.0, effort=9.0).urdf.get_joint("hinge")
    assert (limited.lower, limited.upper, limited.effort, limited.velocity) == (-1.0, 3.0, 9.0, 2.0)


def test_names_change_everywhere(pendulum: URDF) -> None:
    renamed = URDFModifier(pendulum).rename_link("arm", "rod").rename_joint("hinge", "pivot").urdf
    assert renamed.actuated_joint_names == ["pivot", "slide"]
    assert [link.name for link in renamed.links] == ["base", "rod", "hand"]
    q = np.array([0.4, 0.1])
    np.testing.assert_allclose(renamed.get_transform("hand", cfg=q), pendulum.get_transform("hand", cfg=q))


def test_what_is_written_is_read_again(pendulum: URDF, tmp_path: Path) -> None:
    path, calibration = tmp_path / "robot.urdf", {"hinge": {"offset": 0.01, "upper": 1.0}}
    URDFModifier(pendulum).set_link_mass("arm", 99.0).save(path)
    assert URDF.load(path).get_link("arm").mass == 99.0
    save_calibration(calibration, tmp_path / "calibration.json")
    assert load_calibration(tmp_path / "calibration.json") == calibration
    (tmp_path / "plain.json").write_text('{"hinge": {"offset": 1}}')
    assert load_calibration(tmp_path / "plain.json") == {"hinge": {"offset": 1}}
    for text in ("[1]", "{", '{"hinge": 1}'):
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(ValueError, match=r"bad\.json"):
            load_calibration(tmp_path / "bad.json")


def test_robots_of_files_change() -> None:
    arm = URDFToSerialManipulator(get_robot_urdf("xarm6"))
    changed = arm.create_modifier().add_payload(arm.tip_link, 2.0, com=np.zeros(3)).urdf
    q = np.array([0.3, -0.4, -0.9, 0.2, 0.8, 0.1])
    J = arm.jacobian(q)
    p = arm.forward_kinematics(q)[:3, 3]
    linear = J[3:] - np.cross(p, J[:3].T).T
    g = changed.to_manipulator_dynamics(arm.tip_link).gravity_forces(q) - arm.dynamics.gravity_forces(q)
    np.testing.assert_allclose(g, linear.T @ [0, 0, 2.0 * 9.81], atol=1e-9)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda m: m.set_link_mass("nothing", 1.0), "there is no link 'nothing'"),
        (lambda m: m.set_joint_axis("nothing", [1, 0, 0]), "there is no joint 'nothing'"),
        (lambda m: m.set_joint_axis("hinge", [0, 0, 0]), "expected a direction"),
        (lambda m: m.set_link_mass("arm", -1.0), "expected a finite number"),
        (lambda m: m.set_link_mass("arm", math.nan), "expected a finite number"),
        (lambda m: m.set_link_com("arm", [1, 2]), "expected 3 finite numbers"),
        (lambda m: m.set_link_inertia("arm", [[1, 2, 0], [0, 1, 0], [0, 0, 1]]), "symmetric"),
        (lambda m: m.set_joint_limits("hinge", lower=5.0), "lower below upper"),
        (lambda m: m.offset_joint_zero("hinge", math.inf), "offset"),
        (lambda m: m.apply_calibration({"hinge": {"ofset": 1.0}}), "unknown ofset"),
        (lambda m: m.rename_link("arm", "hand"), "already"),
        (lambda m: m.rename_joint("hinge", "slide"), "already"),
    ],
)
def test_changes_that_make_no_sense(pendulum: URDF, change: object, text: str) -> None:
    modifier = URDFModifier(pendulum)
    before = modifier.to_urdf_string()
    with pytest.raises(ValueError, match=text):
        change(modifier)  # type: ignore[operator]
    assert modifier.to_urdf_string() == before


def test_a_scene_of_two(pendulum: URDF) -> None:
    scene = create_multi_robot_scene("cell").add_robot("left", pendulum)
    scene.add_robot("right", pendulum, base_xyz=[1.0, 2.0, 0.5], base_rpy=[0, 0, math.pi / 2])
    assert scene.robot_names == ["left", "right"] and set(scene.robots) == {"left", "right"}
    assert scene.get_robot("right").prefixed_link_names == ["right/base", "right/arm", "right/hand"]
    q = np.array([0.4, 0.1])
    poses = scene.world_link_fk({"left": q, "right": {"hinge": 0.4, "slide": 0.1}})
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [1, 2, 0.5]
    for link, pose in poses["left"].items():
        np.testing.assert_allclose(pose, pendulum.get_transform(link, cfg=q), atol=1e-12)
        np.testing.assert_allclose(poses["right"][link], T @ pose, atol=1e-12)
    tips = scene.world_end_effector_fk({"right": q})
    np.testing.assert_allclose(tips["right"], poses["right"]["hand"], atol=1e-12)
    (one, other) = scene.get_all_collision_geometry({"left": q, "right": q})
    assert (one["robot"], other["robot"], one["link"]) == ("left", "right", "arm")
    np.testing.assert_allclose(other["transform"], T @ one["transform"], atol=1e-12)
    assert scene.get_all_visual_geometry() == []
    assert scene.remove_robot("left").robot_names == ["right"]


def test_robots_touch_where_their_shapes_do(pendulum: URDF) -> None:
    """Upright cylinders of radius 0.1 touch below 0.2; one that leans by a quarter turn reaches 1 m away."""
    scene = Scene.from_urdfs({"one": pendulum, "other": pendulum})
    upright = {"one": np.zeros(2), "other": np.zeros(2)}
    touching = [("one", "arm", "other", "arm")]
    for x, expected in ((0.19, touching), (0.21, []), (0.9, [])):
        scene.set_base_transform("other", base_xyz=[x, 0, 0])
        assert scene.check_inter_robot_collision(upright) == expected
    way = [math.cos(0.5), math.sin(0.5), 0.0]  # in which the first leans
    leaning = {"one": {"hinge": math.pi / 2}}
    for distance, expected in ((1.09, touching), (1.11, [])):
        scene.set_base_transform("other", base_xyz=distance * np.array(way))
        assert scene.check_inter_robot_collision(leaning) == expected


def test_scenes_that_make_no_sense(pendulum: URDF) -> None:
    scene = Scene().add_robot("arm", pendulum)
    with pytest.raises(ValueError, match="already"):
        scene.add_robot("arm", pendulum)
    for call in (scene.get_robot, scene.remove_robot, scene.set_base_transform):
        with pytest.raises(ValueError, match="there is no robot 'leg'"):
            call("leg")
    for call in (scene.world_link_fk, scene.check_inter_robot_collision):
        with pytest.raises(ValueError, match="there is no robot 'leg'"):
            call({"leg": np.zeros(2)})
    with pytest.raises(ValueError, match="rigid motion"):
        scene.set_base_transform("arm", 2 * np.eye(4))
