"""Families of joints: loops, gains, limits, tendons, mocap bodies."""

from typing import Any

import numpy as np

from benchmarks.absurd.draw import Array, Draw
from benchmarks.absurd.setting import Jump, Setting, element
from benchmarks.absurd.shapes import floor, free_body, geom

MOST_GAIN = 1e12


def arm(setting: Setting, links: int, size: float, **joints: Any) -> list[str]:
    """A chain of links, straight or bent, from the world or free: their names. `joints`: attributes of all."""
    draw, names, body = setting.draw, [setting.name("link") for _ in range(links)], ""
    straight, kinds = (
        draw.chance(0.4),
        draw.pick((("hinge",), ("hinge", "slide"), ("ball",), ("hinge", "slide", "ball"))),
    )
    parallel, touches = draw.direction(), draw.pick(("0", "1"))
    for k, name in reversed(list(enumerate(names))):
        kind = "free" if k == 0 and draw.chance(0.2) else draw.pick(kinds)
        axis = parallel if draw.chance(0.5) else draw.direction()
        more = {} if kind == "free" else joints
        one_dof = kind in ("hinge", "slide")
        joint = element("joint", name=f"{name}_joint", type=kind, axis=axis if one_dof else None, **only(more, one_dof))
        rod = np.r_[0, 0, 0, size, 0, 0]
        shape = element("geom", type="capsule", size=0.1 * size, fromto=rod, mass=mass_of(draw), contype=touches)
        turn = [1, 0, 0, 0] if straight else draw.turn()
        body = element("body", joint + shape + body, name=name, pos=[size if k else 0, 0, 0], quat=turn)
        if one_dof and draw.chance(0.3):
            setting.angles[f"{name}_joint"] = draw.uniform(-3, 3)
    setting.world.append(body)
    return names


def only(joints: dict[str, Any], one_dof: bool) -> dict[str, Any]:
    """Ball joints have no limits here."""
    return joints if one_dof else {key: value for key, value in joints.items() if key not in ("range", "limited")}


def mass_of(draw: Draw) -> float:
    """Mostly reasonable."""
    return draw.log(1e-4, 1e4) if draw.chance(0.2) else draw.log(0.1, 10)


def hold(setting: Setting, one: str, other: str | None, size: float) -> None:
    """A weld or a point between two bodies, or a body and the world, where they are or far beyond reach."""
    draw = setting.draw
    beyond = draw.pick((0.0, 0.1, 1.0, 10.0, 1e3)) * size
    if draw.chance(0.5):
        setting.equalities.append(element("connect", body1=one, body2=other, anchor=draw.within(beyond)))
    else:
        pose = np.concatenate([draw.within(beyond), draw.turn()])
        setting.equalities.append(element("weld", body1=one, body2=other, relpose=pose if draw.chance(0.7) else None))


def loops(setting: Setting) -> None:
    """Singular chains closed more often than they can be, by welds and points beyond reach, and gears against them."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    names = arm(setting, draw.count(1, 6), size)
    for _ in range(draw.count(1, 5)):
        one, other = draw.pick(names), draw.pick([*names, None, None])
        if one != other:
            hold(setting, one, other, size)
    couple(setting, names)


def couple(setting: Setting, names: list[str]) -> None:
    """Equations between joints, some of which contradict each other."""
    draw = setting.draw
    single = [name for name in names if joint_kind(setting, name) in ("hinge", "slide")]
    for _ in range(draw.count(0, 3) if single else 0):
        one, other = draw.pick(single), draw.pick(single)
        if one != other:
            along = [draw.uniform(-3, 3), draw.signed(1e-3, 1e3), 0, 0, 0]
            coupled = {"joint1": f"{one}_joint", "joint2": f"{other}_joint"}
            setting.equalities.append(element("joint", **coupled, polycoef=along))


def joint_kind(setting: Setting, link: str) -> str:
    """Of the joint that moves a link."""
    after = "".join(setting.world).split(f"<joint name='{link}_joint' type='")[1]
    return after.split("'")[0]


def gains(setting: Setting) -> None:
    """Springs, dampers, friction, armature and drives of up to 1e12."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    for _ in range(draw.count(1, 3)):
        absurd = {
            "stiffness": draw.log(1, MOST_GAIN),
            "damping": draw.log(1e-3, MOST_GAIN),
            "frictionloss": draw.log(1e-3, MOST_GAIN),
            "armature": draw.log(1e-9, 1e6),
        }
        chosen = {key: value for key, value in absurd.items() if draw.chance(0.4)}
        names = arm(setting, draw.count(1, 4), size, **chosen)
        for name in names:
            if joint_kind(setting, name) in ("hinge", "slide") and draw.chance(0.6):
                drive(setting, joint=f"{name}_joint")
    if draw.chance(0.3):
        floor(setting, -size)
    setting.ctrl = draw.log(1e-2, 1e3)


def drive(setting: Setting, **on: str) -> None:
    """An actuator of absurd gains on a joint or a tendon."""
    draw = setting.draw
    bound = draw.log(1, 1e9)
    limit = {"forcerange": [-bound, bound], "forcelimited": "true"} if draw.chance(0.5) else {}
    kind = draw.pick(("position", "velocity", "motor"))
    if kind == "position":
        limit |= {"kp": draw.log(1, MOST_GAIN), "kv": draw.pick((0.0, draw.log(1e-3, MOST_GAIN)))}
    elif kind == "velocity":
        limit |= {"kv": draw.log(1e-3, MOST_GAIN)}
    gear = draw.signed(1e-2, 1e2) if kind != "motor" else draw.signed(1e-2, 1e6)
    setting.actuators.append(element(kind, gear=gear, **on, **limit))


def limits(setting: Setting) -> None:
    """Joints that start outside their limits, limits that nothing can meet, drives and welds against them."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    lower = draw.signed(1e-3, 10)
    width = draw.pick((1e-9, draw.log(1e-6, 10)))
    names = arm(setting, draw.count(1, 5), size, range=[lower, lower + width], limited="true")
    for name in names:
        if joint_kind(setting, name) in ("hinge", "slide"):
            setting.angles[f"{name}_joint"] = draw.pick((0.0, draw.uniform(-10, 10), draw.signed(1, 1e3)))
            if draw.chance(0.3):
                drive(setting, joint=f"{name}_joint")
    if draw.chance(0.5):
        hold(setting, draw.pick(names), None, size)
    couple(setting, names)
    setting.motors = draw.pick((0.0, draw.log(1, 1e6)))


def tendons(setting: Setting) -> None:
    """Tendons that pull against each other: springs, limits that nothing can meet, equations, drives."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    names = arm(setting, draw.count(2, 5), size)
    names += [free_body(setting, draw.within(3 * size), 0.2 * size, mass_of(draw)) for _ in range(draw.count(0, 2))]
    single = [name for name in names if name.startswith("link") and joint_kind(setting, name) in ("hinge", "slide")]
    found = [tendon(setting, names, single, size) for _ in range(draw.count(1, 4))]
    for name in found:
        if draw.chance(0.3):
            drive(setting, tendon=name)
    for _ in range(draw.count(0, 2)):
        one, other = draw.pick(found), draw.pick([*found, None])
        if one != other:
            along = [draw.uniform(-size, size), draw.signed(0.1, 10), 0, 0, 0]
            setting.equalities.append(element("tendon", tendon1=one, tendon2=other, polycoef=along))
    setting.ctrl = draw.log(0.1, 10)


def tendon(setting: Setting, names: list[str], single: list[str], size: float) -> str:
    """One; returns its name."""
    draw, name = setting.draw, setting.name("tendon")
    lower = draw.pick((0.0, draw.log(0.01, 10) * size))
    absurd = {
        "stiffness": draw.log(1, MOST_GAIN),
        "damping": draw.log(1e-3, MOST_GAIN),
        "frictionloss": draw.log(1e-3, 1e6),
        "range": [lower, lower + draw.log(1e-9, 10) * size],
        "springlength": draw.log(0.01, 10) * size,
    }
    chosen = {key: value for key, value in absurd.items() if draw.chance(0.4)}
    if "range" in chosen:
        chosen["limited"] = "true"
    if single and draw.chance(0.5):
        inner = "".join(
            element("joint", joint=f"{one}_joint", coef=draw.signed(1e-2, 1e2)) for one in set_of(draw, single)
        )
        setting.tendons.append(element("fixed", inner, name=name, **chosen))
        return name
    inner = "".join(element("site", site=site(setting, one, size)) for one in [draw.pick(names), *set_of(draw, names)])
    setting.tendons.append(
        element("spatial", inner + element("site", site=site(setting, "", size)), name=name, **chosen)
    )
    return name


def set_of(draw: Draw, names: list[str]) -> list[str]:
    """One to three of them, none twice."""
    return [str(name) for name in draw.rng.permutation(names)[: draw.count(1, 3)]]


def site(setting: Setting, body: str, size: float) -> str:
    """A point on a body, or in the world; returns its name."""
    name, place = setting.name("site"), setting.draw.within(size)
    text = element("site", name=name, pos=place)
    if not body:
        setting.world.append(text)
        return name
    for k, line in enumerate(setting.world):
        begin = line.find(f"<body name='{body}'")
        if begin >= 0:
            end = line.index(">", begin) + 1
            setting.world[k] = line[:end] + text + line[end:]
    return name


def mocap(setting: Setting) -> None:
    """Mocap bodies that jump, with arms and bodies welded to them, among what they push."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    names = arm(setting, draw.count(1, 5), size)
    names += [free_body(setting, draw.within(2 * size), size, mass_of(draw)) for _ in range(draw.count(0, 4))]
    far = draw.pick((0.1, 1.0, 100.0)) * size
    for _ in range(draw.count(1, 2)):
        name = setting.name("hand")
        shape = geom(setting, size) if draw.chance(0.6) else ""
        setting.world.append(element("body", shape, name=name, mocap="true", pos=draw.within(size)))
        for step in range(5, 300, draw.pick((1, 7, 50))):
            setting.jumps.append(Jump(step, name, draw.within(far), draw.turn()))
        for _ in range(draw.count(0, 2)):
            hold(setting, draw.pick(names), name, size)
    if draw.chance(0.4):
        floor(setting, -size)


def heavy_arms(setting: Setting) -> None:
    """Arms whose masses differ by up to 1e9, some held at their ends."""
    draw, size = setting.draw, setting.draw.log(0.05, 1)
    names = arm(setting, draw.count(2, 6), size)
    masses: Array = np.array([draw.log(1e-4, 1e5) for _ in names])
    for k, line in enumerate(setting.world):
        for name, mass in zip(names, masses, strict=True):
            weight = element("inertial", pos=[size / 2, 0, 0], mass=mass, diaginertia=mass * size**2 * np.ones(3) / 12)
            begin = line.find(f"<body name='{name}'")
            if begin >= 0:
                end = line.index(">", begin) + 1
                line = line[:end] + weight + line[end:]
        setting.world[k] = line
    if draw.chance(0.5):
        hold(setting, names[-1], None, size)
    if draw.chance(0.5):
        floor(setting, -size)
