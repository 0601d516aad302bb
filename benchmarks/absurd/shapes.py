"""Shapes and bodies in MJCF."""

from typing import Any

import numpy as np

from benchmarks.absurd.draw import Array, Draw
from benchmarks.absurd.setting import Setting, element

KINDS = ("box", "sphere", "capsule", "cylinder", "ellipsoid", "hull")


def surface(draw: Draw, harsh: float = 0.2) -> dict[str, Any]:
    """Friction and restitution, now and then of an absurd kind."""
    found: dict[str, Any] = {}
    if draw.chance(harsh):
        slide = draw.pick((0.0, 1e-150, draw.log(1e-3, 1e3), 1e3))
        found["friction"] = [slide, draw.pick((0.0, draw.log(1e-6, 1e2))), draw.pick((0.0, draw.log(1e-6, 1e2)))]
        found["condim"] = draw.pick(("1", "3", "4", "6"))
    return found


def geom(setting: Setting, size: float, mass: float | None = None, kind: str = "", **more: Any) -> str:
    """A geom of about that half width [m]."""
    draw = setting.draw
    kind = kind or draw.pick(KINDS)
    half = size * draw.rng.uniform(0.5, 1.5, 3)
    if draw.chance(0.1):
        half[draw.count(0, 2)] *= 0.02  # a plate, or a needle
    values: dict[str, Any] = {"type": kind, "mass": mass} | surface(draw) | more
    if kind == "hull":
        name = setting.name("mesh")
        points = draw.rng.normal(size=(draw.count(5, 30), 3)) * half
        setting.assets.append(element("mesh", name=name, vertex=points.ravel()))
        return element("geom", **values | {"type": "mesh", "mesh": name})
    return element("geom", **values, size=half[: {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)])


def free_body(setting: Setting, position: Array, size: float, mass: float, kind: str = "") -> str:
    """Adds one; returns its name."""
    name = setting.name("body")
    inner = element("freejoint", name=f"{name}_free") + geom(setting, size, mass, kind)
    setting.world.append(element("body", inner, name=name, pos=position, quat=setting.draw.turn()))
    return name


def floor(setting: Setting, height: float = 0.0) -> None:
    """A plane, level."""
    values = surface(setting.draw)
    setting.world.append(element("geom", type="plane", size=[1, 1, 1], pos=[0, 0, height], **values))


def thin_inertia(draw: Draw, mass: float, size: float) -> Array:
    """Principal moments (3) of a thing that is thin in one or two directions."""
    width = size * np.array([1.0, draw.log(1e-6, 1), draw.log(1e-6, 1)])
    draw.rng.shuffle(width)
    square = width**2
    return mass / 12 * (square.sum() - square)
