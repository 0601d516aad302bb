"""The droid of PyBullet's first example, and the gripper of its arm on its own."""

from __future__ import annotations

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import ZERO, Box, Cylinder, Joint, Link, Placed, Shape, Sphere, Vec3

TURN = 1.57075  # the quarter turn of the files that these stand in for
FREE = (100.0, 100.0)


def _leg(side: str) -> list[Link]:
    leg: list[Shape] = [Placed(box(0.6, 0.2, 0.1), (0, 0, -0.3), (0, TURN, 0))]
    foot: list[Shape] = [box(0.1, 0.4, 0.1)]
    outwards = 1 if side == "right" else -1
    plate = box(0.008, 0.12, 0.40, (outwards * 0.051, 0, -0.27))
    knob = Cylinder("x", min(0, outwards * 0.06), max(0, outwards * 0.06), 0.06)
    wheel: list[Shape] = [Cylinder("z", -0.05, 0.05, 0.035)]
    hub = (Cylinder("z", -0.052, 0.052, 0.015), "metal")
    links = [
        solid(f"{side}_leg", 10.0, leg, "shell", looks=[(plate, "blue"), (knob, "metal")], com=(0, 0, -0.3)),
        solid(f"{side}_base", 10.0, foot, "shell", looks=[(box(0.104, 0.30, 0.02, (0, 0, 0.02)), "blue")]),
    ]
    return links + [solid(f"{side}_{end}_wheel", 1.0, wheel, "graphite", looks=[hub]) for end in ("front", "back")]


def _leg_joints(side: str, x: float) -> list[Joint]:
    base = f"{side}_base"
    joints = [
        Joint(f"base_to_{side}_leg", "fixed", "base_link", f"{side}_leg", (x, 0, 0.25)),
        Joint(f"{side}_base_joint", "fixed", f"{side}_leg", base, (0, 0, -0.6)),
    ]
    for end, y in (("front", 0.133333333333), ("back", -0.133333333333)):
        name = f"{side}_{end}_wheel"
        turn = (0, TURN, 0)
        joints.append(Joint(f"{name}_joint", "continuous", base, name, (0, y, -0.085), turn, (0, 0, 1), drive=FREE))
    return joints


def _fingers(mass: float, grip: bool) -> list[Link]:
    """Both fingers and their tips: mirror images in y."""
    contact = {"lateral_friction": 1.0, "spinning_friction": 1.5} if grip else {}
    links = []
    for side, s in (("left", 1), ("right", -1)):

        def mirrored(shape: Box, s: int = s) -> Box:
            low, high = sorted((s * shape.low[1], s * shape.high[1]))
            return Box((shape.low[0], low, shape.low[2]), (shape.high[0], high, shape.high[2]))

        finger = mirrored(Box((-0.004, 0.003, -0.011), (0.092, 0.019, 0.011)))
        tip, pad = (
            Box((0.090, -0.010, -0.010), (0.120, 0.004, 0.010)),
            Box((0.092, -0.0104, -0.0085), (0.118, -0.008, 0.0085)),
        )
        links.append(solid(f"{side}_gripper", mass, [finger], "metal", com=ZERO, contact=contact))
        pads: list[tuple[Shape, str]] = [(mirrored(pad), "accent")]
        links.append(solid(f"{side}_tip", mass, [mirrored(tip)], "graphite", looks=pads, com=ZERO, contact=contact))
    return links


def _finger_joints(y: float) -> list[Joint]:
    joints = []
    for side, s in (("left", 1.0), ("right", -1.0)):
        joints.append(
            Joint(
                f"{side}_gripper_joint",
                "revolute",
                "gripper_pole",
                f"{side}_gripper",
                (0.2, s * y, 0),
                ZERO,
                (0, 0, s),
                (0.0, 0.548, 1000.0, 0.5),
            )
        )
        joints.append(Joint(f"{side}_tip_joint", "fixed", f"{side}_gripper", f"{side}_tip", ZERO))
    return joints


def _pole(mass: float) -> Link:
    return solid("gripper_pole", mass, [Cylinder("x", 0.0, 0.2, 0.01)], "metal", com=ZERO)


def _droid() -> Files:
    bands: list[tuple[Shape, str]] = [(Cylinder("z", -0.30, 0.30, 0.2), "shell")]
    bands += [(Cylinder("z", low, high, 0.203), "blue") for low, high in ((-0.27, -0.22), (0.22, 0.285))]
    bands += [(box(0.16, 0.02, 0.12, (0, 0.194, -0.06)), "blue"), (box(0.12, 0.02, 0.03, (0, 0.197, 0.06)), "metal")]
    bands += [(Sphere(0.016, (x, 0.199, 0.12)), "accent") for x in (-0.05, 0.05)]
    body = solid("base_link", 10.0, [Cylinder("z", -0.3, 0.3, 0.17)], looks=bands)
    dome: list[tuple[Shape, str]] = [
        (Sphere(0.19, (0, 0, 0.01)), "metal"),
        (Cylinder("z", -0.005, 0.02, 0.196), "blue"),
    ]
    dome += [(Sphere(0.028, (0.10, 0.10, 0.13)), "accent"), (Sphere(0.02, (-0.10, 0.12, 0.11)), "teal")]
    head = solid("head", 10.0, [Sphere(0.16)], looks=dome)
    lens: list[tuple[Shape, str]] = [
        (Cylinder("y", 0.03, 0.045, 0.028), "graphite"),
        (Sphere(0.012, (0, 0.04, 0)), "sky"),
    ]
    eye = solid("box", 1.0, [box(0.08, 0.08, 0.08)], "blue", looks=lens)
    arm = Joint(
        "gripper_extension",
        "prismatic",
        "base_link",
        "gripper_pole",
        (0, 0.19, 0.2),
        (0, 0, TURN),
        (1, 0, 0),
        (-0.38, 0.0, 1000.0, 0.5),
    )
    limits = (-0.38, 0.0, 1000.0, 0.5)
    neck: Vec3 = (0, 0, 0.3)
    swivel = Joint("head_swivel", "continuous", "base_link", "head", neck, ZERO, (0, 0, 1), limits)
    links = [body, *_leg("right"), *_leg("left"), _pole(0.05), *_fingers(0.05, grip=False), head, eye]
    joints = [*_leg_joints("right", 0.22), *_leg_joints("left", -0.22), arm, *_finger_joints(0.02), swivel]
    joints.append(Joint("tobox", "fixed", "head", "box", (0, 0.1214, 0.1214)))
    return place("r2d2.urdf", model("physics", links, joints))


def files() -> Files:
    gripper = model("physics", [_pole(0.5), *_fingers(0.1, grip=True)], _finger_joints(0.01))
    return {**_droid(), **place("pr2_gripper.urdf", gripper)}
