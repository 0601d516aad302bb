"""How a robot of the project is described: links, joints, collision shapes and shells. SI units; rpy in radians."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from robots.mesh import Mesh, convex_hull

Vec3 = tuple[float, float, float]
Rgba = tuple[float, float, float, float]
Parts = dict[str, Mesh]  # material -> mesh

HALF_PI = math.pi / 2
ZERO: Vec3 = (0.0, 0.0, 0.0)
UP: Vec3 = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Cylinder:
    """From `low` to `high` along `axis` (absolute coordinates on that axis) about the line through `centre`."""

    axis: str
    low: float
    high: float
    radius: float
    centre: Vec3 = ZERO


@dataclass(frozen=True)
class Box:
    low: Vec3
    high: Vec3


@dataclass(frozen=True)
class Hull:
    """Convex hull stored as collision/`name`.obj."""

    name: str
    points: list[Vec3]

    def mesh(self) -> Mesh:
        return convex_hull(np.array(self.points))


@dataclass(frozen=True)
class Capsule(Cylinder):
    """A cylinder with a half ball beyond each end."""


@dataclass(frozen=True)
class Sphere:
    radius: float
    centre: Vec3 = ZERO


@dataclass(frozen=True)
class Plane:
    """The half space below z = 0."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh that other files share, by its path from the model's folder."""

    path: str
    scale: Vec3 = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Placed:
    """A shape moved, and turned about its own origin."""

    shape: Cylinder | Box | Hull | Sphere | Plane | MeshFile
    xyz: Vec3 = ZERO
    rpy: Vec3 = ZERO


Shape = Cylinder | Box | Hull | Sphere | Plane | MeshFile | Placed


@dataclass(frozen=True)
class Link:
    name: str
    mass: float = 0.0
    com: Vec3 = ZERO
    inertia: Vec3 = ZERO  # diagonal, about the centre of mass, axes of the link frame
    shapes: list[Shape] = field(default_factory=list)
    visual: str = ""  # key in Robot.shells
    turned: bool = False  # visual and collision turned by pi about z
    looks: list[tuple[Shape, str]] = field(default_factory=list)  # what is seen beside the shells, and its material
    contact: Mapping[str, float] = field(default_factory=dict)  # of PyBullet's <contact>
    products: Vec3 = ZERO  # of inertia: ixy, ixz, iyz


@dataclass(frozen=True)
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    xyz: Vec3
    rpy: Vec3 = ZERO
    axis: Vec3 = ZERO
    limits: tuple[float, float, float, float] | None = None  # lower, upper, effort, velocity
    mimic: str = ""
    damping: float = 0.0  # N m s/rad or N s/m
    friction: float = 0.0  # N m or N
    drive: tuple[float, float] | None = None  # effort, velocity of a joint without limits
    mimic_multiplier: float = 1.0


@dataclass(frozen=True)
class Robot:
    """All that is written under assets/`name`."""

    name: str
    script: str  # that writes it, relative to the repository
    materials: Mapping[str, Rgba]
    links: list[Link]
    joints: list[Joint]
    shells: Mapping[str, Callable[[], Parts]] = field(default_factory=dict)  # by the names that links call theirs by
    textures: Mapping[str, str] = field(default_factory=dict)  # material -> image, by its path from the model's folder
    meshes: str = ""  # where visual/ and collision/ lie, from the model's folder: empty or ends in a slash

    @property
    def hulls(self) -> list[Hull]:
        """Every convex hull that the collision shapes name, once."""
        return list({s.name: s for link in self.links for s in link.shapes if isinstance(s, Hull)}.values())
