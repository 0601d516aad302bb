"""Families of free bodies: overlap, walls that close, ratios, sizes, speeds, surfaces, ground."""

import numpy as np

from benchmarks.absurd.draw import Array
from benchmarks.absurd.setting import Jump, Part, Setting, element
from benchmarks.absurd.shapes import floor, free_body, geom, thin_inertia

UP, STRAIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.0, 1.0])


def overlap(setting: Setting) -> None:
    """Bodies of every shape in each other and in a floor."""
    draw, size = setting.draw, setting.draw.log(0.01, 1)
    for _ in range(draw.count(2, 10)):
        free_body(setting, draw.within(size * draw.pick((0.0, 0.1, 1.0, 2.0))), size, draw.log(0.1, 10))
    if draw.chance(0.6):
        floor(setting, draw.uniform(-size, size))
    if draw.chance(0.3):
        setting.world.append(geom(setting, 2 * size, pos=draw.within(size)))
    if draw.chance(0.4):
        setting.parts += [part(setting, size) for _ in range(draw.count(1, 3))]


def part(setting: Setting, size: float) -> Part:
    """A body, or a thing that is fixed, through the World's own functions."""
    draw, kind = setting.draw, setting.draw.pick(("box", "mesh", "cylinder", "capsule"))
    half = size * (draw.rng.normal(size=(12, 3)) if kind == "mesh" else draw.rng.uniform(0.5, 1.5, 3))
    name, fixed = setting.name("part"), draw.chance(0.2)
    return Part(kind, name, half, draw.log(0.1, 10), draw.within(size), draw.uniform(0, 1), fixed)


def walls(setting: Setting) -> None:
    """A heap between walls that close: driven on slides, or mocap bodies that are moved."""
    draw, size = setting.draw, setting.draw.log(0.01, 1)
    for _ in range(draw.count(1, 8)):
        free_body(setting, draw.within(2 * size), size, draw.log(0.1, 10))
    floor(setting, -2 * size)
    moved, apart = draw.chance(0.4), size * draw.uniform(0.5, 4)
    for axis, side in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0))[: draw.count(1, 2) * 2]:
        name, direction = setting.name("wall"), side * np.eye(3)[axis]
        half = size * np.where(np.arange(3) == axis, 0.2, 4.0)
        box = element("geom", type="box", size=half, mass=draw.log(1, 1e3))
        place = apart * direction
        if moved:
            setting.world.append(element("body", box, name=name, mocap="true", pos=place))
            pace = draw.log(1e-3, 1) * size
            for step in range(10, 300, 10):
                setting.jumps.append(Jump(step, name, place - min(step * pace, 3 * apart) * direction, STRAIGHT))
            continue
        slide = f"{name}_slide"
        joint = element("joint", name=slide, type="slide", axis=-direction)
        setting.world.append(element("body", joint + box, name=name, pos=place))
        force = draw.log(1, 1e9)
        setting.actuators.append(element("motor", joint=slide, gear=force, ctrlrange=[0.5, 1], ctrllimited="true"))


def ratios(setting: Setting) -> None:
    """Towers and heaps with mass ratios to 1e9, light below heavy or the other way round."""
    draw, size = setting.draw, setting.draw.log(0.01, 1)
    count = draw.count(2, 6)
    masses = np.array([draw.log(1e-4, 1e5) for _ in range(count)])
    masses[draw.count(0, count - 1)] = 1e-4
    masses[draw.count(0, count - 1)] = 1e5
    floor(setting)
    tower, kind = draw.chance(0.6), draw.pick(("box", ""))
    for k, mass in enumerate(masses):
        place = [0, 0, size * (2 * k + 1)] if tower else draw.within(2 * size) + 2 * size * UP
        free_body(setting, np.asarray(place, float), size, mass, kind)


def inertias(setting: Setting) -> None:
    """Bodies whose inertia is very thin, turning; some with a centre of mass far away."""
    draw = setting.draw
    for _ in range(draw.count(1, 5)):
        name, mass, size = setting.name("thin"), draw.log(1e-3, 1e3), draw.log(1e-2, 1)
        away = draw.pick((0.0, size, 100 * size)) * draw.direction()
        moments = np.maximum(thin_inertia(draw, mass, size), 1e-15)
        body = element("inertial", pos=away, mass=mass, diaginertia=moments, quat=draw.turn())
        joint = draw.pick(("free", "ball", "hinge"))
        body += element("joint", name=f"{name}_joint", type=joint, axis=draw.direction() if joint == "hinge" else None)
        if draw.chance(0.6):
            body += geom(setting, size, None, draw.pick(("box", "capsule", "sphere")))
        setting.world.append(element("body", body, name=name, pos=draw.within(3)))
        count = {"free": 6, "ball": 3, "hinge": 1}[joint]
        setting.speeds[f"{name}_joint"] = draw.log(1e-2, 1e4) * draw.rng.normal(size=count)
    if draw.chance(0.3):
        floor(setting, -1.0)


LEAST_INERTIA = 1e-9  # [kg m^2] of a cube: below 1e-12 a joint "moves no inertia" and is refused


def sizes(setting: Setting) -> None:
    """Things of a micrometre beside things of a kilometre."""
    draw = setting.draw
    floor(setting)
    height = 0.0
    for _ in range(draw.count(2, 8)):
        size = draw.log(1e-6, 1e3)
        mass = max(draw.pick((min(1e3 * size**3, 1e9), draw.log(1e-3, 1e3))), LEAST_INERTIA / size**2)
        height = height + size if draw.chance(0.7) else size
        free_body(setting, np.array([0, 0, height]) + draw.within(size), size, mass)


def speeds(setting: Setting) -> None:
    """Bodies, and arms, that start at up to a million metres or radians a second."""
    draw, size = setting.draw, setting.draw.log(0.01, 1)
    most = draw.log(1, 1e6)
    for _ in range(draw.count(1, 6)):
        name = free_body(setting, draw.within(4 * size), size, draw.log(0.1, 10))
        spin, flight = most * draw.rng.normal(size=3), most * draw.rng.normal(size=3)
        which = draw.pick((0, 1, 2))
        setting.speeds[f"{name}_free"] = np.concatenate([spin * (which != 1), flight * (which != 0)])
    if draw.chance(0.5):
        floor(setting, -2 * size)
    if draw.chance(0.5):
        chain(setting, size, most)


def chain(setting: Setting, size: float, speed: float) -> None:
    """An arm whose joints start at that speed."""
    draw, body = setting.draw, ""
    for _ in range(draw.count(1, 4)):
        name = setting.name("link")
        axis, kind = draw.direction(), draw.pick(("hinge", "hinge", "slide", "ball"))
        joint = element("joint", name=f"{name}_joint", type=kind, axis=axis)
        shape = element(
            "geom", type="capsule", size=0.1 * size, fromto=np.r_[0, 0, 0, 0, 0, size], mass=draw.log(0.1, 10)
        )
        body = element("body", joint + shape + body, name=name, pos=[0, 0, size])
        setting.speeds[f"{name}_joint"] = speed * draw.rng.normal(size=3 if kind == "ball" else 1)
    setting.world.append(body)


def surfaces(setting: Setting) -> None:
    """Friction of 0, of 1e-150 and to 1000, rolling and spinning too; restitution to 1."""
    draw, size = setting.draw, setting.draw.log(0.01, 1)
    setting.parts += [part(setting, size) for _ in range(draw.count(0, 3))]
    slope = setting.draw.turn() if draw.chance(0.3) else [1, 0, 0, draw.uniform(-1, 1)]
    friction = [draw.pick((0.0, 1e-150, draw.log(1e-3, 1e3))), draw.log(1e-6, 1e2), draw.log(1e-6, 1e2)]
    setting.world.append(element("geom", type="plane", size=[1, 1, 1], quat=slope, friction=friction, condim="6"))
    for _ in range(draw.count(1, 6)):
        name = free_body(setting, draw.within(2 * size) + 2 * size * UP, size, draw.log(0.1, 10))
        setting.speeds[f"{name}_free"] = draw.log(0.1, 100) * draw.rng.normal(size=6)


def ground(setting: Setting) -> None:
    """A height field, rough, with bodies in it and on it."""
    draw, size = setting.draw, setting.draw.log(0.02, 1)
    rows, columns, name = draw.count(2, 12), draw.count(2, 12), setting.name("field")
    heights = draw.rng.random((rows, columns)) ** draw.pick((1.0, 5.0, 0.1))
    extent: Array = size * np.array([draw.log(1, 10), draw.log(1, 10), draw.log(0.1, 30), 1])
    field = element("hfield", name=name, nrow=str(rows), ncol=str(columns), size=extent, elevation=heights.ravel())
    setting.assets.append(field)
    setting.world.append(element("geom", type="hfield", hfield=name))
    for _ in range(draw.count(1, 8)):
        place = draw.within(3 * size) + extent[2] * draw.uniform(0, 1.5) * UP
        body = free_body(setting, place, size * draw.log(0.1, 3), draw.log(0.1, 10))
        setting.speeds[f"{body}_free"] = draw.pick((0.0, draw.log(0.1, 1e3))) * draw.rng.normal(size=6)
