"""A scene, described once: written as MJCF for MuJoCo and for us, and built call by call in PyBullet.

Units are SI, quaternions xyzw, z up. The origin of a body is its joint; its inertia is given outright, so that no two
engines derive different ones from the same shape.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
ORIGIN: Triple = (0.0, 0.0, 0.0)
UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)
G = 9.81  # [m/s^2]


@dataclass(frozen=True)
class Geom:
    """A shape in its body: sphere (radius), capsule and cylinder (radius, half length; along z), box (half extents),
    plane, hull (vertices)."""

    shape: str
    size: tuple[float, ...] = ()
    friction: float = 1.0  # of sliding; the larger one of a pair counts
    spin: float = 0.0  # torsional friction [m]
    roll: float = 0.0  # rolling friction [m]
    product_friction: float | None = None  # where frictions multiply; default: the root
    vertices: tuple[Triple, ...] = ()
    quat: Quaternion = UPRIGHT
    pos: Triple = ORIGIN

    @property
    def factor(self) -> float:
        """The friction to give an engine that multiplies those of a pair."""
        return float(np.sqrt(self.friction)) if self.product_friction is None else self.product_friction

    def inertia(self, mass: float) -> Triple:
        """Principal moments about the centre, in the geom's axes."""
        if self.shape == "sphere":
            moment = 0.4 * mass * self.size[0] ** 2
            return (moment, moment, moment)
        if self.shape == "box":
            x, y, z = (s * s for s in self.size)
            return (mass / 3 * (y + z), mass / 3 * (x + z), mass / 3 * (x + y))
        r, h = self.size[0], 2 * self.size[1]
        if self.shape == "cylinder":
            across = mass * (3 * r * r + h * h) / 12
            return (across, across, mass * r * r / 2)
        if self.shape == "capsule":
            tube, ball = mass * h / (h + 4 / 3 * r), mass * (4 / 3 * r) / (h + 4 / 3 * r)
            across = tube * (h * h / 12 + r * r / 4) + ball * (0.4 * r * r + h * h / 4 + 3 / 8 * h * r)
            return (across, across, tube * r * r / 2 + ball * 0.4 * r * r)
        raise ValueError(f"a {self.shape} has no formula: give Body.inertia")


@dataclass(frozen=True)
class Body:
    """A rigid body; `joint` leads to its parent: free, hinge, slide, ball, or fixed."""

    name: str
    geoms: tuple[Geom, ...] = ()
    mass: float = 0.0
    pos: Triple = ORIGIN  # in the parent
    quat: Quaternion = UPRIGHT
    joint: str = "free"
    axis: Triple = (0.0, 0.0, 1.0)
    damping: float = 0.0
    com: Triple = ORIGIN
    inertia: Triple | None = None  # principal moments about the centre of mass, in the body's axes
    velocity: Triple = ORIGIN  # at the start, of a free body; world axes
    omega: Triple = ORIGIN  # the same, world axes
    q: float = 0.0  # at the start, of a hinge or slide
    v: float = 0.0
    children: tuple["Body", ...] = ()

    @property
    def moments(self) -> Triple:
        """Principal moments about the centre of mass, in the body's axes."""
        if self.inertia is not None:
            return self.inertia
        geom = self.geoms[0]
        turned = rotation(geom.quat) @ np.diag(geom.inertia(self.mass)) @ rotation(geom.quat).T
        if np.abs(turned - np.diag(np.diag(turned))).max() > 1e-12 * np.abs(turned).max():
            raise ValueError(f"body {self.name} has a geom at an angle: give its inertia")
        return (turned[0, 0], turned[1, 1], turned[2, 2])


@dataclass(frozen=True)
class Pair:
    """The friction of two bodies in contact, whatever their geoms say."""

    first: str
    second: str
    friction: float


@dataclass(frozen=True)
class Motor:
    """A spring from a joint to a target: force = kp (target - q)."""

    body: str
    kp: float
    target: float


@dataclass(frozen=True)
class Loop:
    """A point of one body held at a point of another ("world": none)."""

    first: str
    second: str
    point: Triple  # in `first`
    other: Triple  # in `second`


@dataclass(frozen=True)
class Servo:
    """A joint with a controller and the most force it has; gains are those of an engine without motors at the velocity
    level, a spring [N m/rad] and a damper."""

    body: str
    kp: float
    kv: float
    most: float


@dataclass(frozen=True)
class Mimic:
    """Two joints that always have the same position."""

    first: str
    second: str


@dataclass(frozen=True)
class Scene:
    """Everything there is."""

    bodies: tuple[Body, ...]
    gravity: Triple = (0.0, 0.0, -G)
    restitution: float = 0.0
    motors: tuple[Motor, ...] = ()
    servos: tuple[Servo, ...] = ()
    loops: tuple[Loop, ...] = ()
    mimics: tuple[Mimic, ...] = ()
    pairs: tuple[Pair, ...] = ()
    contacts: bool = True
    extent: float = field(default=1.0)  # [m], for the engines' own tolerances

    def walk(self) -> Iterator[tuple[Body, Body | None]]:
        """Every body with its parent, parents first."""

        def below(body: Body, parent: Body | None) -> Iterator[tuple[Body, Body | None]]:
            yield body, parent
            for child in body.children:
                yield from below(child, body)

        for body in self.bodies:
            yield from below(body, None)

    def body(self, name: str) -> Body:
        """The body of that name. Raises KeyError."""
        for body, _ in self.walk():
            if body.name == name:
                return body
        raise KeyError(name)

    def moving(self) -> list[Body]:
        """The bodies that have a joint."""
        return [body for body, _ in self.walk() if body.joint != "fixed"]


def rotation(quat: Sequence[float] | Array) -> Array:
    """(..., 3, 3) of quaternions xyzw (..., 4)."""
    x, y, z, w = np.moveaxis(np.asarray(quat, float), -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, -1) for row in rows], -2)


def about(axis: Sequence[float], angle: float) -> Quaternion:
    """The quaternion of a turn about a unit axis."""
    s = np.sin(angle / 2)
    return (float(axis[0] * s), float(axis[1] * s), float(axis[2] * s), float(np.cos(angle / 2)))


def ground(friction: float = 1.0, **more: float) -> Body:
    """The plane z = 0."""
    return Body("ground", (Geom("plane", friction=friction, **more),), joint="fixed")  # type: ignore[arg-type]
