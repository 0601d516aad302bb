"""The arm in assets/arm6 against the published numbers of its class, Pinocchio and Coal."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import robot_files
from robot_files import coal_meshes, collision_points, obj_arrays, touching
from robots import scene
from robots.arm6 import ARM6 as ROBOT

ARM6 = robot_files.ASSETS / "arm6"
URDF = ARM6 / "arm6.urdf"
MESHES = sorted(ARM6.glob("*/*.obj"))

NEUTRAL = [-0.209817, -1.198085, 1.524398, -1.89711, -1.570796, -0.209817, 0.0, 0.0]
BODIES = [f"link{i}" for i in range(7)] + ["hand"]

# Standard Denavit-Hartenberg parameters of the UR5e as its maker publishes them: a, d (m), alpha (rad); then of each
# link the mass (kg) and the centre of mass (m) in the frame at its far end.
DH = [
    (0.0, 0.1625, math.pi / 2),
    (-0.425, 0.0, 0.0),
    (-0.3922, 0.0, 0.0),
    (0.0, 0.1333, math.pi / 2),
    (0.0, 0.0997, -math.pi / 2),
    (0.0, 0.0996, 0.0),
]
MASSES = [
    (3.761, (0.0, -0.02561, 0.00193)),
    (8.058, (0.2125, 0.0, 0.11336)),
    (2.846, (0.15, 0.0, 0.0265)),
    (1.37, (0.0, -0.0018, 0.01634)),
    (1.3, (0.0, 0.0018, 0.01634)),
    (0.365, (0.0, 0.0, -0.001159)),
]
EFFORTS = [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]
TURN_OF_BASE = np.diag([-1.0, -1.0, 1.0, 1.0])  # the published arm stretches along -x at zero angles, ours along x


def dh_frames(q: np.ndarray) -> list[np.ndarray]:
    """Poses (4, 4) of the frames at the far ends of links 1 to 6."""
    frames, pose = [], TURN_OF_BASE
    for (a, d, alpha), angle in zip(DH, q, strict=True):
        c, s, ca, sa = math.cos(angle), math.sin(angle), math.cos(alpha), math.sin(alpha)
        rows = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]]
        pose = pose @ np.array(rows)
        frames.append(pose)
    return frames


@pytest.fixture(scope="module")
def links() -> dict[str, ET.Element]:
    return {link.get("name"): link for link in ET.parse(URDF).getroot().findall("link")}


@pytest.fixture(scope="module")
def pin_model():
    pin = pytest.importorskip("pinocchio")
    return pin, pin.buildModelFromUrdf(str(URDF))


def test_generator_reproduces_the_committed_files(tmp_path: Path) -> None:
    robot_files.check_committed(ROBOT, ARM6, tmp_path)


def test_joints_have_the_order_and_limits_of_their_class() -> None:
    joints = ET.parse(URDF).getroot().findall("joint")
    names = [f"joint{i}" for i in range(1, 7)] + ["hand_joint", "finger_joint1", "finger_joint2", "grasptarget_hand"]
    assert [j.get("name") for j in joints] == [f"arm6_{n}" for n in names]
    limits = [{k: float(v) for k, v in j.find("limit").attrib.items()} for j in joints if j.get("type") != "fixed"]
    for i, (limit, effort) in enumerate(zip(limits[:6], EFFORTS, strict=True)):
        bound = math.pi if i == 2 else 2 * math.pi
        assert limit == {"lower": -bound, "upper": bound, "effort": effort, "velocity": math.pi}
    assert [limit["lower"] for limit in limits[6:]] == [0.0, 0.0]
    assert [limit["effort"] for limit in limits[6:]] == [235.0, 235.0]
    assert sum(limit["upper"] for limit in limits[6:]) == pytest.approx(0.085)
    assert joints[8].find("mimic").attrib == {"joint": "arm6_finger_joint1", "multiplier": "1", "offset": "0"}


def test_flange_follows_the_published_kinematics(pin_model) -> None:
    pin, model = pin_model
    data = model.createData()
    rng = np.random.default_rng(1)
    for _ in range(50):
        q = rng.uniform(-math.pi, math.pi, 6)
        pin.framesForwardKinematics(model, data, np.concatenate([q, [0.0, 0.0]]))
        flange = data.oMf[model.getFrameId("arm6_link6")].homogeneous
        np.testing.assert_allclose(flange, dh_frames(q)[-1], atol=1e-12)


def test_masses_lie_where_published(links) -> None:
    q = np.random.default_rng(2).uniform(-math.pi, math.pi, 6)
    poses = scene.link_poses(URDF, [*q, 0.0, 0.0], np.eye(4))
    for i, ((mass, com), frame) in enumerate(zip(MASSES, dh_frames(q), strict=True), 1):
        inertial = links[f"arm6_link{i}"].find("inertial")
        assert float(inertial.find("mass").get("value")) == mass
        ours = [float(v) for v in inertial.find("origin").get("xyz").split()]
        np.testing.assert_allclose(poses[f"arm6_link{i}"] @ [*ours, 1.0], frame @ [*com, 1.0], atol=1e-12)


def test_inertias_are_those_of_bodies_as_large_as_the_links(links) -> None:
    for name, link in links.items():
        mass = float(link.find("inertial/mass").get("value"))
        tensor = {key: float(value) for key, value in link.find("inertial/inertia").attrib.items()}
        assert tensor["ixy"] == tensor["ixz"] == tensor["iyz"] == 0.0
        if name == "arm6_grasptarget":
            assert mass == 0.0
            continue
        moments = np.array([tensor[key] for key in ("ixx", "iyy", "izz")])
        assert (2 * moments < moments.sum()).all() and (moments > 0).all(), name
        # Second moments along x, y and z, which cannot exceed those of the mass at the ends of the link's box.
        spread = np.sqrt((moments.sum() / 2 - moments) / mass)
        points = collision_points(ARM6, link)
        half = (points.max(0) - points.min(0)) / 2
        assert (spread < half).all() and (spread > 0.2 * half).all(), name


def test_neutral_pose_points_down_above_the_table(pin_model) -> None:
    pin, model = pin_model
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.array(NEUTRAL))
    target = data.oMf[model.getFrameId("arm6_grasptarget")]
    np.testing.assert_allclose(target.translation, [0.64, 0.0, 0.2], atol=1e-5)
    np.testing.assert_allclose(target.rotation, np.diag([1.0, -1.0, -1.0]), atol=1e-5)
    elbow = data.oMf[model.getFrameId("arm6_link3")].translation
    assert elbow[2] > target.translation[2] + 0.2


def test_finger_pads_are_flat_boxes_that_meet_when_closed(links) -> None:
    for name, side in (("arm6_leftfinger", 1.0), ("arm6_rightfinger", -1.0)):
        pad = links[name].findall("collision")[0]
        centre = np.array([float(v) for v in pad.find("origin").get("xyz").split()])
        size = np.array([float(v) for v in pad.find("geometry/box").get("size").split()])
        assert side * centre[1] - size[1] / 2 == pytest.approx(0.0, abs=1e-12)
    poses = scene.link_poses(URDF, NEUTRAL, np.eye(4))
    tips = poses["arm6_leftfinger"] @ [0.0, 0.0, 0.060, 1.0]
    assert poses["arm6_grasptarget"][2, 3] - tips[2] == pytest.approx(0.007, abs=1e-7)


def test_collision_shapes_of_links_that_are_no_neighbours_are_apart(pin_model) -> None:
    pin, model = pin_model
    shapes = pin.buildGeomFromUrdf(model, str(URDF), pin.GeometryType.COLLISION)
    link = [shape.name.rsplit("_", 1)[0] for shape in shapes.geometryObjects]
    order = [f"arm6_{body}" for body in BODIES] + ["arm6_leftfinger", "arm6_rightfinger"]
    for i, a in enumerate(link):
        for j, b in enumerate(link[:i]):
            apart = abs(order.index(a) - order.index(b)) > 1 and not {a, b} <= {order[-3], order[-1]}
            if apart:
                shapes.addCollisionPair(pin.CollisionPair(j, i))
    assert len(shapes.collisionPairs) > 100
    data, geometry = model.createData(), pin.GeometryData(shapes)
    assert not pin.computeCollisions(model, data, shapes, geometry, np.array(NEUTRAL), False)
    folded = np.array([0.0, -1.5, 3.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert pin.computeCollisions(model, data, shapes, geometry, folded, False)


@pytest.mark.parametrize("path", MESHES, ids=lambda p: p.stem)
def test_meshes_are_closed_and_face_outwards(path: Path) -> None:
    robot_files.check_closed(path)


def test_shells_stay_close_to_the_collision_shapes_and_within_budget(links) -> None:
    triangles = size = 0
    for path in MESHES:
        triangles += len(obj_arrays(path)[1])
        size += path.stat().st_size
    assert triangles < 60_000 and size < 3_000_000
    for name, link in links.items():
        if not link.findall("visual") or name == "arm6_rightfinger":
            continue
        box = collision_points(ARM6, link)
        for visual in link.findall("visual"):
            vertices = obj_arrays(ARM6 / visual.find("geometry/mesh").get("filename"))[0]
            slack = 0.022 if "graphite" in visual.find("material").get("name") else 0.012
            assert (vertices > box.min(0) - slack).all() and (vertices < box.max(0) + slack).all(), name


def test_shells_clear_each_other_at_every_angle() -> None:
    coal = pytest.importorskip("coal")
    shell = {body: f"{body}_{'graphite' if body == 'hand' else 'shell'}" for body in BODIES}
    meshes = coal_meshes(coal, ARM6, list(shell.values()))
    for joint in range(6):
        for value in np.linspace(-math.pi, math.pi, 13):
            q = list(NEUTRAL)
            q[joint] = float(value)
            poses = scene.link_poses(URDF, q, np.eye(4))
            a, b = BODIES[joint], BODIES[joint + 1]
            pair = meshes[shell[a]], poses[f"arm6_{a}"], meshes[shell[b]], poses[f"arm6_{b}"]
            assert not touching(coal, *pair), f"{a} and {b} at q{joint + 1} = {value:.2f}"


def test_a_graphite_core_bridges_every_joint_at_any_angle() -> None:
    coal = pytest.importorskip("coal")
    names = [f"link{i}_{part}" for i in range(6) for part in ("shell", "graphite")] + ["link6_shell"]
    meshes = coal_meshes(coal, ARM6, names)
    rng = np.random.default_rng(5)
    for _ in range(10):
        poses = scene.link_poses(URDF, [*rng.uniform(-math.pi, math.pi, 6), 0.0, 0.0], np.eye(4))
        for k in range(6):
            core, pose = meshes[f"link{k}_graphite"], poses[f"arm6_link{k}"]
            assert touching(coal, core, pose, meshes[f"link{k + 1}_shell"], poses[f"arm6_link{k + 1}"]), k
