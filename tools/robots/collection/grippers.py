"""Grippers. Each stands on its base with z away from the flange; the frame `tool` is where it grips."""

from __future__ import annotations

import math

from robots.bullet_data.common import box
from robots.collection.common import Entry, Part, frame, link, robot
from robots.description import ZERO, Box, Cylinder, Joint, Link, Vec3

Y: Vec3 = (0.0, 1.0, 0.0)
FRICTION = 1.0  # of rubber pads


def _across(side: int, half: float, y: tuple[float, float], z: tuple[float, float]) -> Box:
    """A block from -half to half in x; on the right side, -1, mirrored in y."""
    low, high = sorted(side * end for end in y)
    return Box((-half, low, z[0]), (half, high, z[1]))


def _entry(
    name: str,
    about: str,
    links: list[Link],
    joints: list[Joint],
    joint: str,
    closed: float,
    width: tuple[float, float],
    payload: float,
) -> Entry:
    """A gripper that one joint drives, which is open at 0."""
    return Entry(
        robot(name, links, joints),
        "gripper",
        about,
        {joint: 0.0},
        tool="tool",
        closed={joint: closed},
        width=width,
        payload=payload,
    )


def parallel() -> Entry:
    """Two jaws that slide apart along y; 80 mm between them."""
    stroke = 0.04
    palm = [
        Part(Cylinder("z", 0.0, 0.014, 0.034), "aluminium", "metal"),
        Part(box(0.050, 0.150, 0.056, (0, 0, 0.042)), "drive", "shell"),
        Part(box(0.052, 0.030, 0.020, (0, 0, 0.050)), "plastic", "teal", seen_only=True),
    ]
    left, right = (
        [
            Part(_across(s, 0.011, (0.004, 0.022), (0.0, 0.030)), "aluminium", "metal"),
            Part(_across(s, 0.011, (0.0, 0.010), (0.012, 0.062)), "rubber", "graphite"),
        ]
        for s in (1, -1)
    )
    links = [
        link("palm", palm),
        link("left_jaw", left, friction=FRICTION),
        link("right_jaw", right, friction=FRICTION),
    ]
    limits = (0.0, stroke, 100.0, 0.2)  # how far it has closed
    joints = [
        Joint("jaw_joint", "prismatic", "palm", "left_jaw", (0, stroke, 0.0705), ZERO, (0, -1, 0), limits),
        Joint("right_jaw_joint", "prismatic", "palm", "right_jaw", (0, -stroke, 0.0705), ZERO, Y, limits, "jaw_joint"),
    ]
    tool, mount = frame("tool", "palm", (0, 0, 0.118))
    about = "electric gripper of two jaws that slide, 80 mm wide"
    return _entry("parallel", about, [*links, tool], [*joints, mount], "jaw_joint", stroke, (0.0, 2 * stroke), 3.0)


def two_finger() -> Entry:
    """Two fingers on cranks that keep their tips upright, as a parallelogram does; 85 mm between them."""
    crank, out, base = 0.055, 0.015, 0.075  # length of a crank, y of its pivot, height of the pivot
    lean = round(math.asin((0.0425 + 0.006 - out) / crank), 6)  # of an open crank from upright
    palm = [
        Part(Cylinder("z", 0.0, 0.016, 0.036), "aluminium", "metal"),
        Part(box(0.060, 0.086, 0.050, (0, 0, 0.041)), "drive", "graphite"),
        Part(box(0.034, 0.060, 0.016, (0, 0, 0.072)), "aluminium", "metal"),
        Part(box(0.062, 0.030, 0.020, (0, 0, 0.045)), "plastic", "accent", seen_only=True),
    ]
    rod = [
        Part(box(0.014, 0.012, crank, (0, 0, crank / 2)), "aluminium", "metal"),
        Part(Cylinder("x", -0.012, 0.012, 0.008), "aluminium", "metal"),
        Part(Cylinder("x", -0.012, 0.012, 0.008, (0, 0, crank)), "aluminium", "metal"),
    ]
    links, joints = [link("palm", palm)], []
    for side, s in (("left", 1), ("right", -1)):
        # Open at 0, where the crank leans outwards; a turn about s x closes it.
        finger = [
            Part(_across(s, 0.010, (-0.006, 0.010), (-0.006, 0.016)), "aluminium", "graphite"),
            Part(_across(s, 0.011, (-0.006, 0.004), (0.016, 0.062)), "rubber", "graphite"),
        ]
        links += [link(f"{side}_crank", rod), link(f"{side}_tip", finger, friction=FRICTION)]
        driver = "" if s == 1 else "finger_joint"
        name = "finger_joint" if s == 1 else "right_crank_joint"
        axis: Vec3 = (s, 0, 0)
        joints += [
            Joint(
                name,
                "revolute",
                "palm",
                f"{side}_crank",
                (0, s * out, base),
                (-s * lean, 0, 0),
                axis,
                (0.0, 0.82, 8.0, 2.0),
                driver,
            ),
            Joint(
                f"{side}_tip_joint",
                "revolute",
                f"{side}_crank",
                f"{side}_tip",
                (0, 0, crank),
                (s * lean, 0, 0),
                axis,
                (-0.82, 0.0, 8.0, 2.0),
                "finger_joint",
                mimic_multiplier=-1.0,
            ),
        ]
    tool, mount = frame("tool", "palm", (0, 0, round(base + crank + 0.050, 6)))
    about = "gripper of two fingers on cranks whose tips stay parallel, 85 mm wide"
    return _entry("two_finger", about, [*links, tool], [*joints, mount], "finger_joint", 0.82, (0.0, 0.085), 3.0)


def three_finger() -> Entry:
    """Three fingers of two phalanges a third of a turn apart, all driven by one."""
    count, radius, base, first = 3, 0.045, 0.072, 0.050
    closed = 0.45  # where the pads' tips all but meet
    palm = [
        Part(Cylinder("z", 0.0, 0.016, 0.036), "aluminium", "metal"),
        Part(Cylinder("z", 0.016, 0.066, 0.058), "drive", "shell"),
        Part(Cylinder("z", 0.028, 0.034, 0.0585), "plastic", "blue", seen_only=True),
    ]
    links, joints = [link("palm", palm)], []
    for k in range(count):
        angle = 2 * math.pi * k / count
        # In the finger's frame x points outwards; it closes by turning about -y, z towards -x.
        near = [Part(Box((-0.007, -0.010, -0.006), (0.009, 0.010, first)), "aluminium", "metal")]
        far = [
            Part(Box((-0.004, -0.009, 0.0), (0.008, 0.009, 0.030)), "aluminium", "graphite"),
            Part(Box((-0.009, -0.010, 0.006), (-0.004, 0.010, 0.046)), "rubber", "graphite"),
        ]
        links += [link(f"near{k + 1}", near), link(f"far{k + 1}", far, friction=FRICTION)]
        at: Vec3 = (round(radius * math.cos(angle), 6), round(radius * math.sin(angle), 6), base)
        main = "finger_joint" if k == 0 else f"near{k + 1}_joint"
        joints += [
            Joint(
                main,
                "revolute",
                "palm",
                f"near{k + 1}",
                at,
                (0, 0, round(angle, 9)),
                (0, -1, 0),
                (0.0, closed, 6.0, 2.0),
                "" if k == 0 else "finger_joint",
            ),
            Joint(
                f"far{k + 1}_joint",
                "revolute",
                f"near{k + 1}",
                f"far{k + 1}",
                (0, 0, first),
                ZERO,
                (0, -1, 0),
                (-0.6 * closed, 0.0, 6.0, 2.0),
                "finger_joint",
                mimic_multiplier=-0.6,
            ),
        ]
    tool, mount = frame("tool", "palm", (0, 0, 0.152))
    about = "gripper of three fingers of two phalanges, for round things"
    return _entry("three_finger", about, [*links, tool], [*joints, mount], "finger_joint", closed, (0.0155, 0.072), 2.0)


def vacuum() -> Entry:
    """A suction cup of 40 mm on a stem; nothing moves. What it holds is a weld (manyhands.robots.Vacuum)."""
    palm = [
        Part(Cylinder("z", 0.0, 0.012, 0.034), "aluminium", "metal"),
        Part(box(0.044, 0.060, 0.040, (0, 0, 0.032)), "plastic", "shell"),
        Part(Cylinder("z", 0.052, 0.100, 0.010), "aluminium", "metal"),
        Part(box(0.046, 0.062, 0.006, (0, 0, 0.032)), "plastic", "teal", seen_only=True),
    ]
    cup = [
        Part(Cylinder("z", 0.0, 0.010, 0.014), "rubber", "graphite"),
        Part(Cylinder("z", 0.010, 0.020, 0.020), "rubber", "graphite"),
    ]
    links = [link("palm", palm), link("cup", cup, friction=FRICTION)]
    tool, mount = frame("tool", "cup", (0, 0, 0.020))
    joints = [Joint("cup_joint", "fixed", "palm", "cup", (0, 0, 0.100), ZERO, ZERO), mount]
    about = "suction cup of 40 mm"
    return Entry(robot("vacuum", [*links, tool], joints), "gripper", about, tool="tool", payload=3.0)


def entries() -> list[Entry]:
    return [parallel(), two_finger(), three_finger(), vacuum()]
