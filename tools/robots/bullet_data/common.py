"""What the families share: colours, links whose inertia follows from their shapes, and the files that they become."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robots.description import ZERO, Box, Joint, Link, Rgba, Robot, Shape, Vec3
from robots.inertia import centre_of, inertia_of
from robots.mesh import Mesh
from robots.write import robot_files

SCRIPT = "tools/make_bullet_data.py"
Files = dict[str, bytes]
Looks = Sequence[tuple[Shape, str]]  # what is seen, and its material

COLOURS: dict[str, Rgba] = {
    "shell": (0.93, 0.935, 0.94, 1.0),
    "graphite": (0.115, 0.125, 0.145, 1.0),
    "slate": (0.30, 0.33, 0.37, 1.0),
    "metal": (0.62, 0.64, 0.67, 1.0),
    "accent": (0.98, 0.43, 0.10, 1.0),
    "blue": (0.13, 0.35, 0.66, 1.0),
    "sky": (0.40, 0.64, 0.88, 1.0),
    "teal": (0.02, 0.53, 0.60, 1.0),
    "green": (0.30, 0.62, 0.35, 1.0),
    "yellow": (0.98, 0.78, 0.20, 1.0),
    "red": (0.84, 0.22, 0.20, 1.0),
    "oak": (0.76, 0.61, 0.44, 1.0),
    "walnut": (0.47, 0.34, 0.24, 1.0),
    "fur": (0.66, 0.45, 0.28, 1.0),
    "cream": (0.90, 0.81, 0.66, 1.0),
    "stone": (0.60, 0.60, 0.58, 1.0),
    "marble": (0.95, 0.95, 0.95, 1.0),
    "frosted": (1.0, 1.0, 1.0, 0.7),
    "white": (1.0, 1.0, 1.0, 1.0),
}


def box(x: float, y: float, z: float, at: Vec3 = ZERO) -> Box:
    """Box of these edges about `at`."""
    low = (at[0] - x / 2, at[1] - y / 2, at[2] - z / 2)
    return Box(low, (at[0] + x / 2, at[1] + y / 2, at[2] + z / 2))


def solid(
    name: str,
    mass: float,
    shapes: list[Shape],
    look: str | None = None,
    *,
    looks: Looks | None = None,
    com: Vec3 | None = None,
    like: list[Shape] | None = None,
    contact: Mapping[str, float] | None = None,
) -> Link:
    """Link with the inertia of its collision shapes, or of those it is `like`.

    `look`: the material that the collision shapes are shown in; `looks`: what is seen beside them.
    """
    seen = ([(shape, look) for shape in shapes] if look else []) + list(looks or [])
    body = like or shapes
    if com is None:
        com = centre_of(body) if body and mass > 0 else ZERO
    inertia = inertia_of(mass, body, com) if body and mass > 0 else ZERO
    return Link(name, mass, com, inertia, shapes, looks=seen, contact=contact or {})


def model(
    name: str,
    links: list[Link],
    joints: list[Joint] | None = None,
    *,
    colours: Mapping[str, Rgba] | None = None,
    textures: Mapping[str, str] | None = None,
) -> Robot:
    """A robot with the materials that it uses; `colours` go before the project's."""
    palette = COLOURS | dict(colours or {})
    used = dict.fromkeys(material for link in links for _, material in link.looks)
    materials = {material: palette[material] for material in used}
    return Robot(name, SCRIPT, materials, links, joints or [], textures=textures or {})


def prop(
    name: str,
    shape: Shape,
    mass: float,
    look: str | None = None,
    *,
    base: str = "baseLink",
    looks: Looks | None = None,
    contact: Mapping[str, float] | None = None,
    textures: Mapping[str, str] | None = None,
    colours: Mapping[str, Rgba] | None = None,
) -> Robot:
    """A single body of one shape."""
    link = solid(base, mass, [shape], look, looks=looks, contact=contact)
    return model(name, [link], textures=textures, colours=colours)


def place(path: str, robot: Robot) -> Files:
    """A robot's URDF. Its meshes are written by others, or are other robots'."""
    return {path: robot_files(robot)[0].encode()}


def obj(*meshes: Mesh, digits: int = 4) -> bytes:
    """OBJ of one mesh, or of several objects: each a convex piece to programs that read them so. Without normals."""
    lines, first = [f"# Part of manyhands; written by {SCRIPT}."], 1
    for number, mesh in enumerate(meshes):
        lines += [f"o piece{number}"] if len(meshes) > 1 else []
        # Adding zero turns -0.0 into 0.0.
        lines += ["v " + " ".join(f"{c:.{digits}f}" for c in np.round(p, digits) + 0.0) for p in mesh.vertices]
        lines += ["f " + " ".join(str(v) for v in face) for face in mesh.faces + first]
        first += len(mesh.vertices)
    return ("\n".join(lines) + "\n").encode()
