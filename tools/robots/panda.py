"""The Panda's kinematics, inertias, limits and collision shapes.

Frames, limits, masses and centres of mass are the published values of the Franka Emika Panda as they stand in the robot
description widely used with PyBullet; the inertias are the diagonal ones that PyBullet computes for it, so that an arm
that reads its inertias from this file moves as one does there. SI units; rpy in radians.
"""

from __future__ import annotations

import math

from robots.description import HALF_PI, UP, ZERO, Box, Cylinder, Hull, Joint, Link, Rgba, Robot, Shape, Vec3
from robots.panda_shells import SHELLS

MATERIALS: dict[str, Rgba] = {
    "shell": (0.93, 0.935, 0.94, 1.0),
    "graphite": (0.115, 0.125, 0.145, 1.0),
    "accent": (0.98, 0.43, 0.10, 1.0),
    "metal": (0.62, 0.64, 0.67, 1.0),
}


R = 0.055


def _circle(axis: str, centre: Vec3, radius: float, count: int = 12) -> list[Vec3]:
    i = "xyz".index(axis)
    points = []
    for s in range(count):
        p = list(centre)
        p[(i + 1) % 3] += radius * math.cos(2 * math.pi * s / count)
        p[(i + 2) % 3] += radius * math.sin(2 * math.pi * s / count)
        points.append((p[0], p[1], p[2]))
    return points


# PyBullet's finger tapers: this is its width where it touches things.
FINGER: list[Shape] = [
    Box((-0.009, 0.0, 0.035), (0.009, 0.0160, 0.0538)),
    Box((-0.0105, 0.003, 0.0), (0.0105, 0.0264, 0.035)),
]
NECK = [*_circle("z", (0.0, 0.0, -0.20), 0.052), *_circle("y", (0.0, 0.046, 0.0), 0.046)]
NECK += _circle("y", (0.0, 0.126, 0.0), 0.046)
PALM: list[Shape] = [
    Box((-0.024, -0.060, -0.026), (0.024, 0.060, 0.010)),
    Box((-0.032, -0.104, 0.010), (0.032, 0.100, 0.066)),
]

GRIP = {"lateral_friction": 1.0}
LINKS: list[Link] = [
    Link(
        "panda_link0",
        2.9,
        (0.0, 0.0, 0.05),
        (0.01346, 0.01708, 0.02107),
        [
            Box((-0.154, -0.095, 0.0), (0.072, 0.095, 0.035)),
            Box((-0.145, -0.05, 0.035), (0.0, 0.05, 0.086)),
            Cylinder("z", 0.0, 0.140, 0.060),
        ],
        "link0",
    ),
    Link(
        "panda_link1",
        2.70,
        (0.0, -0.04, -0.05),
        (0.02297, 0.01777, 0.01148),
        [Cylinder("z", -0.192, 0.0, R), Cylinder("y", -0.129, 0.0, R)],
        "link1",
    ),
    Link(
        "panda_link2",
        2.73,
        (0.0, -0.04, 0.06),
        (0.02349, 0.01161, 0.01823),
        [Cylinder("y", -0.194, 0.0, R), Cylinder("z", 0.0, 0.130, R)],
        "link2",
    ),
    Link(
        "panda_link3",
        2.04,
        (0.01, 0.01, -0.05),
        (0.01092, 0.01258, 0.01197),
        [Cylinder("z", -0.121, 0.0, R), Cylinder("y", 0.0, 0.111, R, (0.0825, 0.0, 0.0))],
        "link3",
    ),
    Link(
        "panda_link4",
        2.08,
        (-0.03, 0.03, 0.02),
        (0.01134, 0.01225, 0.01306),
        [Cylinder("y", 0.0, 0.124, R, (-0.0825, 0.0, 0.0)), Cylinder("z", 0.0, 0.111, R)],
        "link4",
    ),
    Link(
        "panda_link5",
        3.00,
        (0.0, 0.04, -0.12),
        (0.03568, 0.02985, 0.01280),
        [Cylinder("z", -0.265, -0.19, R), Cylinder("y", 0.045, 0.130, 0.052), Hull("link5_neck", NECK)],
        "link5",
    ),
    Link(
        "panda_link6",
        1.30,
        (0.04, 0.0, 0.0),
        (0.003428, 0.005117, 0.005988),
        [Cylinder("z", -0.044, 0.056, 0.048), Cylinder("y", -0.051, 0.082, 0.044, (0.088, 0.0, 0.0))],
        "link6",
    ),
    Link(
        "panda_link7",
        0.20,
        (0.0, 0.0, 0.08),
        (0.0003616, 0.0003622, 0.0005921),
        [Cylinder("z", 0.052, 0.107, 0.044), Cylinder("z", 0.060, 0.096, 0.038, (0.043, 0.043, 0.0))],
        "link7",
    ),
    Link("panda_link8"),
    Link("panda_hand", 0.81, (0.0, 0.0, 0.04), (0.003719, 0.001016, 0.003388), PALM, "hand"),
    Link("panda_leftfinger", 0.10, (0.0, 0.01, 0.02), (4.168e-5, 3.874e-5, 1.694e-5), FINGER, "finger", contact=GRIP),
    Link(
        "panda_rightfinger",
        0.10,
        (0.0, -0.01, 0.02),
        (4.168e-5, 3.874e-5, 1.694e-5),
        FINGER,
        "finger",
        turned=True,
        contact=GRIP,
    ),
    Link("panda_grasptarget"),
]

_STRONG, _WEAK = (87.0, 2.175), (12.0, 2.61)


def _arm(number: int, xyz: Vec3, roll: float, lower: float, upper: float, drive: tuple[float, float]) -> Joint:
    return Joint(
        f"panda_joint{number}",
        "revolute",
        f"panda_link{number - 1}",
        f"panda_link{number}",
        xyz,
        (roll, 0.0, 0.0),
        UP,
        (lower, upper, *drive),
    )


JOINTS: list[Joint] = [
    _arm(1, (0.0, 0.0, 0.333), 0.0, -2.9671, 2.9671, _STRONG),
    _arm(2, ZERO, -HALF_PI, -1.8326, 1.8326, _STRONG),
    _arm(3, (0.0, -0.316, 0.0), HALF_PI, -2.9671, 2.9671, _STRONG),
    _arm(4, (0.0825, 0.0, 0.0), HALF_PI, -3.1416, 0.0, _STRONG),
    _arm(5, (-0.0825, 0.384, 0.0), -HALF_PI, -2.9671, 2.9671, _WEAK),
    _arm(6, ZERO, HALF_PI, -0.0873, 3.8223, _WEAK),
    _arm(7, (0.088, 0.0, 0.0), HALF_PI, -2.9671, 2.9671, _WEAK),
    Joint("panda_joint8", "fixed", "panda_link7", "panda_link8", (0.0, 0.0, 0.107)),
    Joint("panda_hand_joint", "fixed", "panda_link8", "panda_hand", ZERO, (0.0, 0.0, -math.pi / 4)),
    Joint(
        "panda_finger_joint1",
        "prismatic",
        "panda_hand",
        "panda_leftfinger",
        (0.0, 0.0, 0.0584),
        ZERO,
        (0.0, 1.0, 0.0),
        (0.0, 0.04, 20.0, 0.2),
    ),
    Joint(
        "panda_finger_joint2",
        "prismatic",
        "panda_hand",
        "panda_rightfinger",
        (0.0, 0.0, 0.0584),
        ZERO,
        (0.0, -1.0, 0.0),
        (0.0, 0.04, 20.0, 0.2),
        mimic="panda_finger_joint1",
    ),
    Joint("panda_grasptarget_hand", "fixed", "panda_hand", "panda_grasptarget", (0.0, 0.0, 0.105)),
]

PANDA = Robot("panda", "tools/make_panda.py", MATERIALS, LINKS, JOINTS, SHELLS)
