"""The robot as posed, coloured triangles: reads the URDF and its OBJ files, and places them by forward kinematics."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robots.mesh import Mesh

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Triangles:
    """Triangle soup: corners (n, 3, 3) m, corner normals (n, 3, 3), material name of each batch with its count."""

    corners: Array
    normals: Array
    batches: list[tuple[str, int]]


def _transform(xyz: Array, rotation: Array) -> Array:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, xyz
    return pose


def _rpy(roll: float, pitch: float, yaw: float) -> Array:
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _floats(text: str | None, default: str = "0 0 0") -> Array:
    return np.array([float(v) for v in (text or default).split()])


def _origin(element: ET.Element) -> Array:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = (float(v) for v in _floats(origin.get("rpy")))
    return _transform(_floats(origin.get("xyz")), _rpy(roll, pitch, yaw))


def _motion(joint: ET.Element, q: float) -> Array:
    element = joint.find("axis")
    axis = _floats(element.get("xyz") if element is not None else None, "1 0 0")
    if joint.get("type") == "prismatic":
        return _transform(q * axis, np.eye(3))
    x, y, z = axis
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return _transform(np.zeros(3), np.eye(3) + math.sin(q) * k + (1 - math.cos(q)) * k @ k)


def link_poses(urdf: Path, q: list[float], base: Array) -> dict[str, Array]:
    """World pose (4, 4) of every link; `q` holds the movable joints in file order."""
    root = ET.parse(urdf).getroot()
    values = iter(q)
    poses: dict[str, Array] = {}
    for joint in root.findall("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        assert parent is not None and child is not None
        above = poses.setdefault(str(parent.get("link")), base)
        moved = np.eye(4) if joint.get("type") == "fixed" else _motion(joint, next(values))
        poses[str(child.get("link"))] = above @ _origin(joint) @ moved
    return poses


def read_obj(path: Path) -> tuple[Array, Array]:
    """Corners and corner normals, both (n, 3, 3), of an OBJ file of triangles "f v//vn v//vn v//vn"."""
    v, n, f = [], [], []
    for line in path.read_text().splitlines():
        tag, *rest = line.split()
        if tag == "v":
            v.append([float(a) for a in rest])
        elif tag == "vn":
            n.append([float(a) for a in rest])
        elif tag == "f":
            f.append([[int(i) - 1 for i in corner.split("//")] for corner in rest])
    faces = np.array(f)
    return np.array(v)[faces[..., 0]], np.array(n)[faces[..., 1]]


def posed_robot(urdf: Path, q: list[float], base: Array) -> Triangles:
    """Every visual of the robot in the world frame."""
    poses = link_poses(urdf, q, base)
    corners, normals, batches = [], [], []
    for link in ET.parse(urdf).getroot().findall("link"):
        for visual in link.findall("visual"):
            mesh, material = visual.find("geometry/mesh"), visual.find("material")
            assert mesh is not None and material is not None
            pose = poses[str(link.get("name"))] @ _origin(visual)
            v, n = read_obj(urdf.parent / str(mesh.get("filename")))
            corners.append(v @ pose[:3, :3].T + pose[:3, 3])
            normals.append(n @ pose[:3, :3].T)
            batches.append((str(material.get("name")), len(v)))
    return Triangles(np.concatenate(corners), np.concatenate(normals), batches)


def placed(mesh: Mesh, xyz: tuple[float, float, float], material: str) -> Triangles:
    """A mesh of robots.mesh moved to `xyz`."""
    corners = mesh.vertices[mesh.faces] + np.array(xyz)
    return Triangles(corners, mesh.normals[mesh.normal_faces], [(material, len(mesh.faces))])


def together(*parts: Triangles) -> Triangles:
    """One soup of several."""
    return Triangles(
        np.concatenate([p.corners for p in parts]),
        np.concatenate([p.normals for p in parts]),
        [b for p in parts for b in p.batches],
    )
