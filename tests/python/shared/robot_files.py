"""What the tests of our robots' files share: reading them, and what every robot's files must be."""

from __future__ import annotations

import filecmp
import math
import sys
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
ASSETS = ROOT / "assets"
sys.path.insert(0, str(ROOT / "tools"))

from robots import scene  # noqa: E402
from robots.description import Robot  # noqa: E402
from robots.write import write  # noqa: E402


def check_committed(robot: Robot, folder: Path, scratch: Path) -> None:
    """The generator writes exactly the files in `folder`."""
    write(robot, scratch)
    fresh = {p.relative_to(scratch) for p in scratch.rglob("*") if p.is_file()}
    kept = {p.relative_to(folder) for p in folder.rglob("*") if p.is_file()}
    assert fresh == kept
    different = [str(p) for p in sorted(fresh) if not filecmp.cmp(scratch / p, folder / p, shallow=False)]
    assert not different, f"run {robot.script}"


def check_closed(path: Path) -> None:
    """The mesh of an OBJ file is closed and faces outwards, and so do its normals."""
    vertices, faces = obj_arrays(path)
    edges = Counter((int(f[i]), int(f[(i + 1) % 3])) for f in faces for i in range(3))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    assert (a * np.cross(b, c)).sum() / 6 > 1e-7
    corners, normals = scene.read_obj(path)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((area[:, None, :] * normals).sum(-1) > 0).mean() > 0.999
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1.0, atol=2e-3)


def obj_arrays(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (t, 3)."""
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices = np.array([[float(a) for a in rest] for tag, *rest in lines if tag == "v"])
    faces = np.array([[int(c.split("/")[0]) - 1 for c in rest] for tag, *rest in lines if tag == "f"])
    return vertices, faces


def collision_points(folder: Path, link: ET.Element) -> np.ndarray:
    """Points that span the bounding box of a link's collision shapes, in the link frame."""
    clouds = []
    for element in link.findall("collision"):
        shape = element.find("geometry")[0]
        if shape.tag == "mesh":
            points = obj_arrays(folder / shape.get("filename"))[0]
        elif shape.tag == "box":
            half = np.array([float(v) for v in shape.get("size").split()]) / 2
            points = half * np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        else:
            radius, length = float(shape.get("radius")), float(shape.get("length"))
            turn = np.arange(0, 360, 1.0) * math.pi / 180
            ring = [radius * np.cos(turn), radius * np.sin(turn)]
            points = np.concatenate([np.stack([*ring, np.full_like(turn, h)], -1) for h in (-length / 2, length / 2)])
        origin = element.find("origin")
        roll, pitch, yaw = (float(v) for v in origin.get("rpy").split())
        rx, ry, rz = (axis_rotation(i, a) for i, a in enumerate((roll, pitch, yaw)))
        clouds.append(points @ (rz @ ry @ rx).T + np.array([float(v) for v in origin.get("xyz").split()]))
    return np.concatenate(clouds)


def axis_rotation(axis: int, angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    r = np.eye(3)
    r[j, j], r[j, k], r[k, j], r[k, k] = c, -s, s, c
    return r


def coal_meshes(coal, folder: Path, names: list[str]) -> dict[str, object]:
    """Triangle meshes for Coal of the visual files of these names."""
    meshes = {}
    for name in names:
        vertices, faces = obj_arrays(folder / "visual" / f"{name}.obj")
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(faces), len(vertices))
        model.addVertices(vertices)
        model.addTriangles(faces)
        model.endModel()
        meshes[name] = model
    return meshes


def touching(coal, a, pose_a: np.ndarray, b, pose_b: np.ndarray) -> bool:
    result = coal.CollisionResult()
    poses = [coal.Transform3s(p[:3, :3], p[:3, 3]) for p in (pose_a, pose_b)]
    return coal.collide(a, poses[0], b, poses[1], coal.CollisionRequest(), result) > 0
