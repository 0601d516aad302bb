"""Small meshes that several families use."""

from __future__ import annotations

import math

import numpy as np

from robots.description import Vec3
from robots.mesh import Mesh, convex_hull, lathe, length, shade


def chamfered(x: float, y: float, z: float, bevel: float) -> Mesh:
    """Box with its edges cut off."""
    half = np.array([x, y, z]) / 2
    corners = [
        (2 * np.array(signs) - 1) * (half - bevel * (np.arange(3) != face))
        for face in range(3)
        for signs in np.ndindex(2, 2, 2)
    ]
    return convex_hull(np.array(corners))


def ellipsoid(centre: Vec3, radii: Vec3, rings: int = 8, segments: int = 14) -> Mesh:
    angles = [math.pi * (k / rings - 0.5) for k in range(rings + 1)]
    profile = [(math.cos(a) if 0 < k < rings else 0.0, math.sin(a)) for k, a in enumerate(angles)]
    unit = lathe("z", profile, (0.0, 0.0, 0.0), segments)
    normals = unit.normals / np.array(radii)
    return Mesh(
        unit.vertices * np.array(radii) + np.array(centre),
        unit.faces,
        normals / length(normals)[:, None],
        unit.normal_faces,
    )


def shifted(mesh: Mesh, up: float) -> Mesh:
    return Mesh(mesh.vertices + np.array([0.0, 0.0, up]), mesh.faces, mesh.normals, mesh.normal_faces)


def upright_to_y(mesh: Mesh) -> Mesh:
    """A mesh made with z up, for files that have y up."""
    turn = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
    return Mesh(mesh.vertices @ turn, mesh.faces, mesh.normals @ turn, mesh.normal_faces)


def loft(profile: list[tuple[float, float, float]], steps: int = 4) -> Mesh:
    """Closed shell of rounded squares (half width, corner radius, height), from its bottom to its floor inside."""
    vertices: list[list[float]] = []
    for half, corner, height in profile:
        for quarter in range(4):
            for k in range(steps + 1):
                a = math.pi / 2 * (quarter + k / steps)
                signs = (1 if quarter in (0, 3) else -1, 1 if quarter in (0, 1) else -1)
                x, y = (s * (half - corner) for s in signs)
                vertices.append([x + corner * math.cos(a), y + corner * math.sin(a), height])
    n = 4 * (steps + 1)
    last = (len(profile) - 1) * n
    centres = len(vertices)
    vertices += [[0.0, 0.0, profile[0][2]], [0.0, 0.0, profile[-1][2]]]
    faces = []
    for s in range(n):
        t = (s + 1) % n
        for r in range(len(profile) - 1):
            a, b = r * n, (r + 1) * n
            faces += [[a + s, a + t, b + t], [a + s, b + t, b + s]]
        faces += [[centres, t, s], [centres + 1, last + s, last + t]]
    return shade(np.array(vertices), np.array(faces))
