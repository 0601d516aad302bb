"""What PyBullet's own examples need, on scenes of our own; the numbers are PyBullet's."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands.pybullet as p

QUARTER = math.sqrt(0.5)


@pytest.fixture
def sim() -> Iterator[Any]:
    client = p.connect(p.DIRECT)
    assert client == 0
    yield p
    p.disconnect(client)


def mjcf(folder: Path, world: str) -> tuple[int, ...]:
    file = folder / "scene.xml"
    file.write_text(f'<mujoco model="m"><compiler inertiafromgeom="true"/><worldbody>{world}</worldbody></mujoco>')
    return p.loadMJCF(str(file))


def joints(body: int) -> list[tuple[bytes, int, bytes, int]]:
    """Names but for the counter in those of fixed joints, types, links and parents."""
    infos = [p.getJointInfo(body, j) for j in range(p.getNumJoints(body))]
    return [(b"jointfix" if i[1].startswith(b"jointfix") else i[1], i[2], i[12], i[16]) for i in infos]


def test_a_joint_of_mjcf_is_a_link_without_mass_and_the_body_is_fixed_to_it(sim: Any, tmp_path: Path) -> None:
    (body,) = mjcf(
        tmp_path,
        """<body name="torso" pos="0 0 1"><geom type="sphere" size=".1"/>
             <body name="arm" pos=".2 0 0">
               <joint name="yaw" type="hinge" axis="0 0 1" pos="0 0 .1"/>
               <joint name="pitch" type="hinge" axis="0 1 0" pos="0 0 .1" range="-30 60" limited="true"/>
               <geom type="capsule" fromto="0 0 0 .4 0 0" size=".05"/>
             </body>
           </body>""",
    )
    assert p.getBodyInfo(body) == (b"torso", b"m")
    assert joints(body) == [
        (b"yaw", p.JOINT_REVOLUTE, b"link0_2", -1),
        (b"pitch", p.JOINT_REVOLUTE, b"link0_3", 0),
        (b"jointfix", p.JOINT_FIXED, b"arm", 1),
    ]
    assert [p.getDynamicsInfo(body, j)[0] for j in (0, 1)] == [0, 0]
    assert p.getJointInfo(body, 0)[8:10] == (1, 0)  # no limits
    assert p.getJointInfo(body, 1)[8:10] == pytest.approx((-math.pi / 6, math.pi / 3))
    assert p.getLinkState(body, 0)[4] == pytest.approx((0.2, 0, 1.1))
    assert p.getLinkState(body, 2)[4] == pytest.approx((0.2, 0, 1))
    assert p.getLinkState(body, 2)[0] == pytest.approx((0.4, 0, 1))
    p.setGravity(0, 0, -10)
    p.stepSimulation()
    assert p.getBaseVelocity(body)[0][2] < 0  # its base is free


def test_what_joints_of_mjcf_move_in_the_world_stands_on_a_base_without_mass(sim: Any, tmp_path: Path) -> None:
    bodies = mjcf(
        tmp_path,
        """<geom name="rail" type="capsule" size=".02 1"/><geom name="floor" type="plane" size="1 1 1" pos="0 0 -1"/>
           <body name="cart" pos="0 0 .5">
             <joint name="slider" type="slide" axis="1 0 0" ref="1"/><geom type="sphere" size=".1" pos="0 0 .3"/>
           </body>
           <body name="post"><joint type="fixed" name="stays"/><geom type="sphere" size=".1"/></body>""",
    )
    assert [p.getBodyInfo(body)[0] for body in bodies] == [b"rail", b"floor", b"link2_1", b"link3_1"]
    assert [p.getDynamicsInfo(body, -1)[0] for body in bodies] == [0, 0, 0, 0]
    assert joints(bodies[2]) == [
        (b"slider", p.JOINT_PRISMATIC, b"link2_2", -1),
        (b"jointfix", p.JOINT_FIXED, b"cart", 0),
    ]
    assert joints(bodies[3])[0] == (b"stays", p.JOINT_FIXED, b"link3_2", -1)
    assert p.getJointState(bodies[2], 0)[0] == 0  # ref does not count
    assert p.getLinkState(bodies[2], 1)[4] == pytest.approx((0, 0, 0.5))


def test_the_centre_of_mass_of_mjcf_is_that_of_the_last_geom_by_its_ends(sim: Any, tmp_path: Path) -> None:
    ends, ball = (
        '<geom type="capsule" fromto="0 0 .1 .2 0 .3" size=".05"/>',
        '<geom type="sphere" size=".1" pos="1 0 0"/>',
    )
    inertial = '<inertial mass="10" pos=".1 .2 .3"/>'
    wanted = {ends: (0.1, 0, 0.2), ball: (0, 0, 0), ends + ball: (0, 0, 0), ball + ends: (0.1, 0, 0.2)}
    wanted[ends + inertial] = (0.1, 0.2, 0.3)
    for geoms, centre in wanted.items():
        (body,) = mjcf(
            tmp_path,
            f'<body name="a">{ball}<body name="b"><joint name="j" type="hinge" axis="0 0 1"/>{geoms}</body></body>',
        )
        assert p.getLinkState(body, 1)[2] == pytest.approx(centre), geoms
    assert p.getDynamicsInfo(body, 1)[0] == pytest.approx(10)
    (body,) = mjcf(tmp_path, f'<body name="a" pos="0 0 1">{ball}{ends}<body name="b">{ball}</body></body>')
    assert p.getBasePositionAndOrientation(body)[0] == pytest.approx((0, 0, 1))  # the base's is put there
    assert p.getLinkState(body, 0)[4] == pytest.approx((-0.1, 0, 0.8))


ROBOT = """<robot name="r">
  <link name="base"><inertial><origin xyz=".1 .2 .3"/><mass value="2"/>
    <inertia ixx=".1" iyy=".2" izz=".25" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="left">{part}</link><link name="right">{part}</link><link name="hand">{part}</link>
  <joint name="l" type="{left}"><parent link="base"/><child link="left"/><origin xyz="1 0 0"/></joint>
  <joint name="h" type="revolute"><parent link="left"/><child link="hand"/><origin xyz="1 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="r" type="continuous"><parent link="base"/><child link="right"/><origin xyz="0 1 0"/>
    <axis xyz="0 0 1"/></joint>
</robot>"""
PART = """<inertial><origin xyz=".3 0 0"/><mass value="1"/>
  <inertia ixx=".02" iyy=".03" izz=".04" ixy="0" ixz="0" iyz="0"/></inertial>"""


def robot(folder: Path, left: str = "spherical", **options: Any) -> int:
    file = folder / "robot.urdf"
    file.write_text(ROBOT.format(part=PART, left=left))
    flags = p.URDF_USE_INERTIA_FROM_FILE | options.pop("flags", 0)
    return p.loadURDF(str(file), flags=flags, **options)


def test_links_are_counted_depth_first_or_as_the_file_has_them(sim: Any, tmp_path: Path) -> None:
    names = [p.getJointInfo(robot(tmp_path), j)[12] for j in range(3)]
    assert names == [b"left", b"hand", b"right"]
    body = robot(tmp_path, flags=p.URDF_MAINTAIN_LINK_ORDER)
    assert [p.getJointInfo(body, j)[12] for j in range(3)] == [b"left", b"right", b"hand"]
    assert [p.getJointInfo(body, j)[16] for j in range(3)] == [-1, -1, 0]
    assert p.getLinkState(body, 2)[4] == pytest.approx((2, 0, 0))


def kinetic_energy(body: int) -> float:
    energy = 0.0
    for link in range(-1, p.getNumJoints(body)):
        mass, _, inertia = p.getDynamicsInfo(body, link)[:3]
        if link < 0:
            (v, w), turn = p.getBaseVelocity(body), p.getBasePositionAndOrientation(body)[1]
        else:
            state = p.getLinkState(body, link, computeLinkVelocity=1)
            v, w, turn = state[6], state[7], state[1]
        spin = np.reshape(p.getMatrixFromQuaternion(turn), (3, 3)).T @ w
        energy += 0.5 * (mass * np.dot(v, v) + np.dot(inertia, spin * spin))
    return float(energy)


def test_the_padded_mass_matrix_gives_the_kinetic_energy(sim: Any, tmp_path: Path) -> None:
    """With flags=1 lists have the base's pose and a place more behind the velocities of base and spherical joints."""
    body = robot(tmp_path)
    turn = p.getQuaternionFromEuler([0.3, -0.4, 0.5])
    twist = p.getQuaternionFromEuler([0.2, 0.6, -0.1])
    p.resetBasePositionAndOrientation(body, [1, 2, 3], turn)
    p.resetBaseVelocity(body, [0.1, 0.2, 0.3], [0.4, 0.5, 0.6])
    p.resetJointStateMultiDof(body, 0, twist, [0.7, 0.8, 0.9])
    p.resetJointState(body, 1, 0.4, 1.1)
    p.resetJointState(body, 2, 0.5, 1.2)
    q = [1, 2, 3, *turn, *twist, 0.4, 0.5]
    v = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0, 0.7, 0.8, 0.9, 0, 1.1, 1.2])
    M = np.array(p.calculateMassMatrix(body, q, flags=1))
    assert M.shape == (13, 13)
    assert [M[6, 6], M[10, 10], np.abs(M[6]).sum(), np.abs(M[10]).sum()] == [1, 1, 1, 1]
    assert 0.5 * v @ M @ v == pytest.approx(kinetic_energy(body))
    p.setGravity(0, 0, -10)
    still = np.array(p.calculateInverseDynamics(body, q, [0] * 13, [0] * 13, flags=1))
    assert still[:3] == pytest.approx([0, 0, 50])
    assert still[[6, 10]] == pytest.approx([0, 0])
    pushed = np.array(p.calculateInverseDynamics(body, q, [0] * 13, list(v), flags=1)) - still
    assert pushed == pytest.approx(M @ v)


def test_the_mass_matrix_of_a_free_body_is_about_its_base_s_centre_of_mass(sim: Any, tmp_path: Path) -> None:
    body = robot(tmp_path, left="continuous")
    M = np.array(p.calculateMassMatrix(body, [0, 0, 0]))
    places = [p.getLinkState(body, j)[0] for j in range(3)]
    centre = sum(np.subtract(place, p.getBasePositionAndOrientation(body)[0]) for place in places)
    x, y, z = centre  # masses are 1 kg
    assert M[3:6, :3] == pytest.approx(np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]]), abs=1e-12)


def test_motors_of_several_joints_take_lists_of_lists(sim: Any, tmp_path: Path) -> None:
    body = robot(tmp_path, useFixedBase=True)
    target = (0, 0, QUARTER, QUARTER)
    p.setJointMotorControlMultiDofArray(
        body, [0, 1, 2], p.POSITION_CONTROL, targetPositions=[target, [0.5], [-0.5]],
        forces=[[100, 100, 100], [100], [100]], positionGains=[0.2] * 3, velocityGains=[1] * 3,
    )  # fmt: skip
    for _ in range(240):
        p.stepSimulation()
    (ball, *_), (hand, *_), (right, *_) = p.getJointStatesMultiDof(body, [0, 1, 2])
    assert abs(np.dot(ball, target)) == pytest.approx(1, abs=1e-6)
    assert (*hand, *right) == pytest.approx((0.5, -0.5), abs=1e-3)
    with pytest.raises(p.error, match="forces has not as many items as jointIndices"):
        p.setJointMotorControlMultiDofArray(body, [0, 1], p.TORQUE_CONTROL, forces=[[1, 1, 1]])
    with pytest.raises(p.error, match="three numbers"):
        p.setJointMotorControlMultiDof(body, 0, p.TORQUE_CONTROL, force=[1, 1])


def free_joints(body: int) -> None:
    for joint in (1, 2):
        p.setJointMotorControl2(body, joint, p.VELOCITY_CONTROL, force=0)
    p.setJointMotorControlMultiDof(body, 0, p.POSITION_CONTROL, targetPosition=[0, 0, 0, 1], force=[0, 0, 0])


def test_torques_turn_a_spherical_joint_for_one_step(sim: Any, tmp_path: Path) -> None:
    body = robot(tmp_path, useFixedBase=True)
    free_joints(body)
    p.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
    p.setJointMotorControlMultiDof(body, 0, p.TORQUE_CONTROL, force=[0, 0, 2])
    p.stepSimulation()
    speed = p.getJointStateMultiDof(body, 0)[1]
    M = np.array(p.calculateMassMatrix(body, [0, 0, 0, 1, 0, 0], flags=1))
    assert speed == pytest.approx(np.linalg.solve(M, [0, 0, 2, 0, 0, 0])[:3] / 240)
    p.stepSimulation()
    assert p.getJointStateMultiDof(body, 0)[1] == pytest.approx(speed, abs=1e-3)


@pytest.mark.parametrize("most", [1000.0, 50.0])
def test_a_stable_pd_is_stable_where_an_explicit_one_is_not(sim: Any, tmp_path: Path, most: float) -> None:
    """Damping 100 N m s on 0.1 kg m^2: a step of an explicit PD would reverse the speed four times over."""
    body = robot(tmp_path, useFixedBase=True)
    free_joints(body)
    target = (0, QUARTER, 0, QUARTER)
    for _ in range(480):
        p.setJointMotorControlMultiDofArray(
            body, [0, 1, 2], p.STABLE_PD_CONTROL, targetPositions=[target, [0.3], [0.7]],
            forces=[[most] * 3, [most], [most]], positionGains=[1000] * 3, velocityGains=[100] * 3,
        )  # fmt: skip
        p.stepSimulation()
    (ball, spin, *_), (hand, *_), (right, *_) = p.getJointStatesMultiDof(body, [0, 1, 2])
    assert abs(np.dot(ball, target)) == pytest.approx(1, abs=1e-3)
    assert np.abs(spin).max() < 0.1
    assert (*hand, *right) == pytest.approx((0.3, 0.7), abs=0.02)


LOOP = """<robot name="loop"><link name="base"/>
  {legs}
</robot>"""
LEG = """<link name="hip{i}">{part}</link><link name="knee{i}">{part}</link>
  <joint name="hip{i}" type="continuous"><parent link="base"/><child link="hip{i}"/><origin xyz="{x} 0 0"/>
    <axis xyz="0 1 {tilt}"/></joint>
  <joint name="knee{i}" type="continuous"><parent link="hip{i}"/><child link="knee{i}"/><origin xyz="0 0 -.2"/>
    <axis xyz="0 1 0"/></joint>"""
THIN = """<inertial><origin xyz="0 0 -.1"/><mass value=".1"/>
  <inertia ixx="1e-4" iyy="1e-4" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>"""


def test_a_loop_of_joints_that_are_not_quite_parallel_swings(sim: Any, tmp_path: Path) -> None:
    """A parallelogram, as in minitaur's legs, whose ends are 10 um apart along the axes, where no joint moves them."""
    file = tmp_path / "loop.urdf"
    legs = [LEG.format(i=i, x=x, tilt=tilt, part=THIN) for i, x, tilt in ((0, 0, 2e-4), (1, 0.1, -1e-4))]
    file.write_text(LOOP.format(legs="".join(legs)))
    body = p.loadURDF(str(file), useFixedBase=True, flags=p.URDF_USE_INERTIA_FROM_FILE)
    hips, knees = (0, 2), (1, 3)
    for hip, knee in zip(hips, knees, strict=True):
        p.resetJointState(body, hip, 0.5)
        p.resetJointState(body, knee, 0)
    across = (-0.1 * math.cos(0.5), 1e-5, -0.1 - 0.1 * math.sin(0.5))
    p.createConstraint(body, 1, body, 3, p.JOINT_POINT2POINT, [0, 0, 0], [0, 0, -0.1], across)
    for joint in range(4):
        p.setJointMotorControl2(body, joint, p.VELOCITY_CONTROL, force=0)
        p.changeDynamics(body, joint, linearDamping=0, angularDamping=0)
    p.setGravity(0, 0, -10)
    p.setTimeStep(0.002)
    fastest, lowest = 0.0, 0.0
    for _ in range(500):
        p.stepSimulation()
        fastest = max(fastest, *(abs(p.getJointState(body, joint)[1]) for joint in range(4)))
        lowest = min(lowest, p.getJointState(body, 0)[0])
    assert lowest < -0.3
    assert fastest < 30


def test_closest_points_take_shapes_in_place_of_bodies(sim: Any) -> None:
    ball = p.createCollisionShape(p.GEOM_SPHERE, radius=0.1)
    box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.2] * 3)
    given = {"collisionShapeA": ball, "collisionShapePositionA": [0.5, 0, 1]}
    (point,) = p.getClosestPoints(
        -1, -1, 100, collisionShapeB=box, collisionShapePositionB=[1.5, 0, 1], **given
    )  # fmt: skip
    assert point[1:5] == (-1, -1, -2, -2)
    assert (*point[5], *point[6], point[8]) == pytest.approx((0.6, 0, 1, 1.3, 0, 1, 0.7), abs=1e-6)
    body = p.createMultiBody(0, box, basePosition=[1.5, 0, 1])
    assert body == 0
    (point,) = p.getClosestPoints(-1, body, 100, **given)
    assert point[1:5] == (-1, body, -2, -1)
    assert p.getNumBodies() == 1
    assert p.createMultiBody(0, box) == 1


def test_colours_of_lines_may_have_an_opacity(sim: Any) -> None:
    assert p.addUserDebugLine([0, 0, 0], [1, 0, 0], [1, 0, 0, 1]) == -1
    with pytest.raises(p.error, match="lineColorRGB needs 3 numbers"):
        p.addUserDebugLine([0, 0, 0], [1, 0, 0], [1, 0])
