#!/usr/bin/env python3
"""Render docs/images/grasps.png: where `manyhands.planning.grasps_in` takes hold of a box, a cylinder, a prism and a
frame that is a mesh.

python tools/draw_grasps.py
"""

import itertools
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import manyhands as mh
from manyhands import collision, planning
from manyhands import kinematics as kin

OUT = Path(__file__).resolve().parent.parent / "docs/images/grasps.png"
STEP = 0.26  # between objects [m]
RAISED = 0.1  # above the floor [m]
LINES = 40  # of each object
TOOL = np.array([0, 0, 0.118])  # in the gripper's base [m]


def box_mesh(half: tuple[float, float, float], centre: NDArray[np.float64], first: int) -> tuple[list, list]:
    corners = [centre + np.array(sign) * half for sign in itertools.product((-1, 1), repeat=3)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return corners, [[first + k for k in t] for t in triangles]


def frame() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Four bars around a hole, 60 mm wide."""
    vertices, triangles = [], []
    for sign in (-1, 1):
        for half, at in (((0.03, 0.005, 0.04), (0, 1, 0)), ((0.005, 0.02, 0.04), (1, 0, 0))):
            corners, faces = box_mesh(half, 0.025 * sign * np.array(at), len(vertices))
            vertices += corners
            triangles += faces
    return np.array(vertices), np.array(triangles)


def prism() -> NDArray[np.float64]:
    around = np.arange(6) * math.pi / 3
    return np.array([(r * math.cos(a), r * math.sin(a), z) for a in around for r, z in ((0.03, -0.05), (0.022, 0.05))])


def colour(share: float) -> tuple[float, float, float]:
    """From red, the worst, to green."""
    return (0.9 * (1 - share) + 0.05, 0.75 * share + 0.1, 0.15)


def add_lines(world: mh.World, name: str, found: planning.Grasps, at: NDArray[np.float64]) -> None:
    _, first = np.unique(found.points.round(9), axis=0, return_index=True)
    span = np.ptp(found.quality) or 1.0
    for k in np.sort(first)[:: max(1, len(first) // LINES)]:
        a, b = found.points[k] + at
        z = (b - a) / np.linalg.norm(b - a)
        x = np.cross(z, [1.0, 0, 0] if abs(z[0]) < 0.5 else [0, 1.0, 0])
        x /= np.linalg.norm(x)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = np.column_stack([x, np.cross(z, x), z]), (a + b) / 2
        share = float((found.quality[k] - found.quality.min()) / span)
        size = (0.0008, float(np.linalg.norm(b - a)) / 2 + 0.01)
        world.add_cylinder(f"{name}{k}", *size, 1.0, *kin.pose(T), fixed=True, colour=colour(share))


def main() -> None:
    vertices, triangles = frame()
    shapes = {
        "box": collision.Box([0.02, 0.03, 0.06]),
        "cylinder": collision.Cylinder(0.03, 0.06),
        "prism": collision.Convex(prism()),
        "frame": collision.Mesh(vertices, triangles),
    }
    world = mh.World()
    world.add_plane("floor")
    glass = (0.35, 0.55, 0.85, 0.45)
    for column, (name, shape) in enumerate(shapes.items()):
        at = np.array([STEP * (column - 1.5), 0, RAISED])
        found = planning.grasps(shape, samples=200, approach=(0, 0, -1), tilt=1.2)
        if name == "box":
            world.add_box(name, [0.02, 0.03, 0.06], 1.0, at, fixed=True, colour=glass)
        elif name == "cylinder":
            world.add_cylinder(name, 0.03, 0.06, 1.0, at, fixed=True, colour=glass)
        elif name == "prism":
            world.add_mesh(name, prism(), 1.0, at, colour=glass)
        else:
            for bar in range(4):
                corners = vertices[8 * bar : 8 * bar + 8]
                world.add_box(
                    f"bar{bar}", np.ptp(corners, axis=0) / 2, 1.0, at + corners.mean(0), fixed=True, colour=glass
                )
        add_lines(world, name, found, at)
        T = kin.matrix(found.position[0] + at, found.quaternion[0])
        position = T[:3, 3] - T[:3, :3] @ TOOL
        world.add(mh.robots.load("parallel"), position, kin.pose(T)[1], name=f"hand{column}")
        q = np.array(world.q)
        for joint in ("jaw_joint", "right_jaw_joint"):
            q[world.model.joint(f"hand{column}/{joint}").iq] = 0.04 - found.width[0] / 2
        world.q = q
        print(f"{name}: {len(found.width)} grasps, quality {found.quality.min():.3f} to {found.quality.max():.3f}")
    camera = mh.Camera.perspective(1200, 480, math.radians(13)).orbit(
        [0, 0, 0.17], 2.0, math.radians(20), math.radians(-16)
    )
    picture = world.render(camera, look=mh.Look(antialiasing=3, shadow_rays=16))
    Image.fromarray(picture.colour).save(OUT, optimize=True)


if __name__ == "__main__":
    main()
