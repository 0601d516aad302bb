"""The arm in assets/panda against published numbers, PyBullet's own description of the robot, Pinocchio and Coal."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import robot_files
from robot_files import coal_meshes, collision_points, obj_arrays, touching
from robots import scene
from robots.panda import PANDA as ROBOT

PANDA = robot_files.ASSETS / "panda"
URDF = PANDA / "panda.urdf"

NEUTRAL = [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.0, 0.0]
LINKS = [f"panda_link{i}" for i in range(1, 9)]
LINKS += ["panda_hand", "panda_leftfinger", "panda_rightfinger", "panda_grasptarget"]

# Mass (kg), centre of mass (m), diagonal inertia about it (kg m^2).
FINGER_INERTIA = (4.168e-5, 3.874e-5, 1.694e-5)
INERTIAL = {
    "panda_link1": (2.70, (0, -0.04, -0.05), (0.02297, 0.01777, 0.01148)),
    "panda_link2": (2.73, (0, -0.04, 0.06), (0.02349, 0.01161, 0.01823)),
    "panda_link3": (2.04, (0.01, 0.01, -0.05), (0.01092, 0.01258, 0.01197)),
    "panda_link4": (2.08, (-0.03, 0.03, 0.02), (0.01134, 0.01225, 0.01306)),
    "panda_link5": (3.00, (0, 0.04, -0.12), (0.03568, 0.02985, 0.01280)),
    "panda_link6": (1.30, (0.04, 0, 0), (0.003428, 0.005117, 0.005988)),
    "panda_link7": (0.20, (0, 0, 0.08), (0.0003616, 0.0003622, 0.0005921)),
    "panda_hand": (0.81, (0, 0, 0.04), (0.003719, 0.001016, 0.003388)),
    "panda_leftfinger": (0.10, (0, 0.01, 0.02), FINGER_INERTIA),
    "panda_rightfinger": (0.10, (0, -0.01, 0.02), FINGER_INERTIA),
}

# Bounding boxes (m, link frame) of the collision hulls of PyBullet's file.
BOXES = {
    "panda_link0": ((-0.154, -0.095, 0.0), (0.072, 0.095, 0.140)),
    "panda_link1": ((-0.055, -0.129, -0.192), (0.055, 0.055, 0.055)),
    "panda_link2": ((-0.055, -0.194, -0.055), (0.055, 0.055, 0.130)),
    "panda_link3": ((-0.055, -0.055, -0.121), (0.138, 0.111, 0.055)),
    "panda_link4": ((-0.138, -0.055, -0.055), (0.055, 0.124, 0.111)),
    "panda_link5": ((-0.055, -0.055, -0.265), (0.055, 0.130, 0.052)),
    "panda_link6": ((-0.048, -0.051, -0.044), (0.132, 0.082, 0.056)),
    "panda_link7": ((-0.044, -0.044, 0.052), (0.081, 0.081, 0.107)),
    "panda_hand": ((-0.032, -0.104, -0.026), (0.032, 0.100, 0.066)),
    "panda_leftfinger": ((-0.0105, 0.0, 0.0), (0.0105, 0.0264, 0.0538)),
    "panda_rightfinger": ((-0.0105, -0.0264, 0.0), (0.0105, 0.0, 0.0538)),
}

MESHES = sorted(PANDA.glob("*/*.obj"))


@pytest.fixture(scope="module")
def links() -> dict[str, ET.Element]:
    return {link.get("name"): link for link in ET.parse(URDF).getroot().findall("link")}


@pytest.fixture(scope="module")
def pin_model():
    pin = pytest.importorskip("pinocchio")
    return pin, pin.buildModelFromUrdf(str(URDF))


@pytest.fixture(scope="module")
def bullet():
    """PyBullet client with our arm, with the inertias of the file, and its own."""
    pybullet = pytest.importorskip("pybullet")
    data = pytest.importorskip("pybullet_data")
    client = pybullet.connect(pybullet.DIRECT)
    ours = pybullet.loadURDF(str(URDF), useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
    theirs = pybullet.loadURDF(f"{data.getDataPath()}/franka_panda/panda.urdf", useFixedBase=True)
    yield pybullet, ours, theirs
    pybullet.disconnect(client)


def test_generator_reproduces_the_committed_files(tmp_path: Path) -> None:
    robot_files.check_committed(ROBOT, PANDA, tmp_path)


def test_neutral_pose_puts_the_grasp_target_where_panda_gym_has_it(pin_model) -> None:
    pin, model = pin_model
    assert model.nq == 9
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.array(NEUTRAL))
    pose = data.oMf[model.getFrameId("panda_grasptarget")]
    np.testing.assert_allclose(pose.translation, [0.63844, 0.0, 0.19740], atol=6e-6)
    quaternion = pin.Quaternion(pose.rotation).coeffs()
    np.testing.assert_allclose(abs(quaternion[:2]), [0.999997, 0.0023], atol=5e-5)


def test_masses_centres_and_inertias_are_the_published_ones(links) -> None:
    for name, (mass, com, inertia) in INERTIAL.items():
        inertial = links[name].find("inertial")
        assert float(inertial.find("mass").get("value")) == mass
        assert tuple(float(v) for v in inertial.find("origin").get("xyz").split()) == com
        tensor = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
        assert tuple(tensor[k] for k in ("ixx", "iyy", "izz")) == inertia
        assert tensor["ixy"] == tensor["ixz"] == tensor["iyz"] == 0.0
        assert inertia[0] < inertia[1] + inertia[2] and inertia[1] < inertia[0] + inertia[2]
        assert inertia[2] < inertia[0] + inertia[1]
    for name in ("panda_link8", "panda_grasptarget"):
        assert float(links[name].find("inertial/mass").get("value")) == 0.0


def test_joints_and_links_have_pybullets_names_order_types_and_limits(bullet) -> None:
    pybullet, ours, theirs = bullet
    assert pybullet.getNumJoints(ours) == pybullet.getNumJoints(theirs) == 12
    for i in range(12):
        a, b = pybullet.getJointInfo(ours, i), pybullet.getJointInfo(theirs, i)
        assert a[12].decode() == LINKS[i]
        # Index, name, type, q index, v index, flags, damping, friction, limits, effort, velocity, link name.
        assert a[:13] == b[:13]
        assert a[16] == b[16]
        if a[2] != pybullet.JOINT_FIXED:
            np.testing.assert_allclose(a[13], b[13])


def test_link_poses_equal_pybullets_own_robot(bullet) -> None:
    pybullet, ours, theirs = bullet
    rng = np.random.default_rng(3)
    moving = [0, 1, 2, 3, 4, 5, 6, 9, 10]
    for _ in range(20):
        for joint in moving:
            lower, upper = pybullet.getJointInfo(ours, joint)[8:10]
            value = rng.uniform(lower, upper)
            for body in (ours, theirs):
                pybullet.resetJointState(body, joint, value)
        for i in range(12):
            a, b = (pybullet.getLinkState(body, i, computeForwardKinematics=True) for body in (ours, theirs))
            np.testing.assert_allclose(a[4], b[4], atol=1e-9)
            np.testing.assert_allclose(a[5], b[5], atol=1e-9)


def test_pybullet_reads_inertias_and_friction(bullet) -> None:
    pybullet, ours, theirs = bullet
    for i, name in enumerate(LINKS):
        info, other = pybullet.getDynamicsInfo(ours, i), pybullet.getDynamicsInfo(theirs, i)
        if name in INERTIAL:
            mass, com, inertia = INERTIAL[name]
            assert info[0] == pytest.approx(mass)
            np.testing.assert_allclose(info[2], inertia, rtol=1e-6)
            np.testing.assert_allclose(info[3], com, atol=1e-9)
            # Ours, read from the file, are the ones PyBullet computes for its own robot.
            np.testing.assert_allclose(info[2], other[2], rtol=1e-3)
        # Lateral friction, restitution, rolling friction. PyBullet makes its fingers soft and resist spinning, which
        # its solver needs for a grasp and ours does not.
        assert (info[1], *info[5:7]) == (other[1], *other[5:7])


@pytest.mark.parametrize("name", sorted(BOXES))
def test_collision_shapes_fill_the_published_boxes(links, name: str) -> None:
    points = collision_points(PANDA, links[name])
    tolerance = 1e-9 if "finger" in name else 0.003
    np.testing.assert_allclose(points.min(0), BOXES[name][0], atol=tolerance)
    np.testing.assert_allclose(points.max(0), BOXES[name][1], atol=tolerance)


def test_finger_pads_are_flat_boxes_that_meet_when_closed(links) -> None:
    for name, side in (("panda_leftfinger", 1.0), ("panda_rightfinger", -1.0)):
        pad = links[name].findall("collision")[0]
        centre = np.array([float(v) for v in pad.find("origin").get("xyz").split()])
        size = np.array([float(v) for v in pad.find("geometry/box").get("size").split()])
        assert side * centre[1] - size[1] / 2 == pytest.approx(0.0, abs=1e-12)
        assert [centre[2] - size[2] / 2, centre[2] + size[2] / 2] == pytest.approx([0.035, 0.0538], abs=1e-12)


@pytest.mark.parametrize("path", MESHES, ids=lambda p: p.stem)
def test_meshes_are_closed_and_face_outwards(path: Path) -> None:
    robot_files.check_closed(path)


@pytest.mark.parametrize("path", sorted((PANDA / "collision").glob("*.obj")), ids=lambda p: p.stem)
def test_collision_hulls_are_convex_and_small(path: Path) -> None:
    vertices, faces = obj_arrays(path)
    assert len(vertices) <= 40
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = (normal[:, None, :] * (vertices[None] - a[:, None])).sum(-1)
    assert height.max() < 3e-5


def test_shells_stay_close_to_the_collision_shapes_and_within_budget(links) -> None:
    triangles = size = 0
    for path in MESHES:
        triangles += len(obj_arrays(path)[1])
        size += path.stat().st_size
    assert triangles < 60_000 and size < 3_000_000
    for name in BOXES:
        if name == "panda_rightfinger":
            continue
        box = collision_points(PANDA, links[name])
        for visual in links[name].findall("visual"):
            vertices = obj_arrays(PANDA / visual.find("geometry/mesh").get("filename"))[0]
            slack = 0.022 if "graphite" in visual.find("material").get("name") else 0.010
            assert (vertices > box.min(0) - slack).all() and (vertices < box.max(0) + slack).all(), name


def test_shells_clear_each_other_over_every_joints_range() -> None:
    coal = pytest.importorskip("coal")
    meshes = coal_meshes(coal, PANDA, [f"link{i}_shell" for i in range(8)] + ["hand_shell"])
    ranges = [(-2.96, 2.96), (-1.83, 1.83), (-2.96, 2.96), (-3.14, -0.01), (-2.96, 2.96), (-0.08, 3.82), (-2.96, 2.96)]
    bodies = [f"link{i}" for i in range(8)] + ["hand"]
    for joint, (lower, upper) in enumerate(ranges):
        for value in np.linspace(lower, upper, 9):
            q = list(NEUTRAL)
            q[joint] = float(value)
            poses = scene.link_poses(URDF, q, np.eye(4))
            for k in range(len(bodies) - 1):
                a, b = bodies[k], bodies[k + 1]
                pair = meshes[f"{a}_shell"], poses[f"panda_{a}"], meshes[f"{b}_shell"], poses[f"panda_{b}"]
                assert not touching(coal, *pair), f"{a} and {b} at q{joint + 1} = {value:.2f}"


def test_a_graphite_core_bridges_every_joint_at_any_angle() -> None:
    coal = pytest.importorskip("coal")
    names = [f"link{i}_{part}" for i in range(8) for part in ("shell", "graphite")] + ["hand_shell"]
    meshes = coal_meshes(coal, PANDA, names)
    rng = np.random.default_rng(5)
    for _ in range(10):
        q = [*rng.uniform([-2.9, -1.8, -2.9, -3.1, -2.9, 0.0, -2.9], [2.9, 1.8, 2.9, 0.0, 2.9, 3.8, 2.9]), 0.0, 0.0]
        poses = scene.link_poses(URDF, q, np.eye(4))
        for k in range(8):
            child = f"link{k + 1}" if k < 7 else "hand"
            core, pose = meshes[f"link{k}_graphite"], poses[f"panda_link{k}"]
            assert touching(coal, core, pose, meshes[f"{child}_shell"], poses[f"panda_{child}"]), child
