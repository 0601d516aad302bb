"""A six-axis collaborative arm with a parallel gripper: kinematics, inertias, limits and collision shapes.

The arm's Denavit-Hartenberg lengths, link masses, centres of mass, torques and speeds are those that Universal Robots
publishes of its UR5e; link frames sit at the joints, z along the axis, and the arm stretches along x of the base at
zero angles. Inertias are those of solid rods and boxes of the links' sizes. The gripper is the project's own: 85 mm
between the pads and up to 235 N, as a Robotiq 2F-85. SI units; rpy in radians.
"""

from __future__ import annotations

import math

from robots.arm6_shells import SHELLS
from robots.description import HALF_PI, UP, ZERO, Box, Cylinder, Joint, Link, Rgba, Robot, Shape, Vec3

MATERIALS: dict[str, Rgba] = {
    "shell": (0.88, 0.895, 0.905, 1.0),
    "graphite": (0.115, 0.125, 0.145, 1.0),
    "accent": (0.02, 0.53, 0.60, 1.0),
    "metal": (0.62, 0.64, 0.67, 1.0),
}

# Denavit-Hartenberg lengths of the UR5e.
D1, A2, A3, D4, D5, D6 = 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996

STROKE = 0.0425  # of each finger
FINGER_BASE, TARGET = 0.080, 0.133  # heights of the fingers' frames and of the grasp target over the flange


def _rod(axis: str, mass: float, radius: float, length: float) -> Vec3:
    """Diagonal inertia of a solid cylinder about its centre, to 1e-6 kg m^2."""
    across = round(mass * (3 * radius**2 + length**2) / 12, 6)
    along = round(mass * radius**2 / 2, 6)
    return (along if axis == "x" else across, along if axis == "y" else across, along if axis == "z" else across)


def _block(mass: float, x: float, y: float, z: float) -> Vec3:
    """Diagonal inertia of a solid box about its centre, to 1e-8 kg m^2."""
    a, b, c = (round(mass * (u * u + v * v) / 12, 8) for u, v in ((y, z), (z, x), (x, y)))
    return a, b, c


FINGER: list[Shape] = [
    Box((-0.011, 0.0, 0.035), (0.011, 0.015, 0.060)),
    Box((-0.011, 0.003, 0.0), (0.011, 0.026, 0.035)),
]
FINGER_INERTIA = _block(0.06, 0.022, 0.02, 0.06)

GRIP = {"lateral_friction": 1.0}
LINKS: list[Link] = [
    Link(
        "arm6_link0",
        4.0,
        (0.0, 0.0, 0.04),
        _rod("z", 4.0, 0.075, 0.092),
        [Cylinder("z", 0.0, 0.022, 0.092), Cylinder("z", 0.022, 0.092, 0.066)],
        "link0",
    ),
    Link(
        "arm6_link1",
        3.761,
        (0.0, -0.00193, -0.02561),
        _rod("z", 3.761, 0.062, 0.14),
        [Cylinder("z", -0.068, 0.0, 0.062), Cylinder("y", -0.068, 0.064, 0.062)],
        "link1",
    ),
    Link(
        "arm6_link2",
        8.058,
        (-0.2125, 0.0, 0.11336),
        _rod("x", 8.058, 0.054, 0.53),
        [
            Cylinder("z", 0.071, 0.202, 0.060),
            Cylinder("x", A2, 0.0, 0.052, (0.0, 0.0, 0.1375)),
            Cylinder("z", 0.074, 0.194, 0.054, (A2, 0.0, 0.0)),
        ],
        "link2",
    ),
    Link(
        "arm6_link3",
        2.846,
        (-0.2422, 0.0, 0.0265),
        _rod("x", 2.846, 0.045, 0.48),
        [
            Cylinder("z", -0.054, 0.070, 0.052),
            Cylinder("x", A3, 0.0, 0.044, (0.0, 0.0, 0.008)),
            Cylinder("z", -0.048, 0.072, 0.0435, (A3, 0.0, 0.0)),
        ],
        "link3",
    ),
    Link(
        "arm6_link4",
        1.37,
        (0.0, -0.01634, -0.0018),
        _rod("z", 1.37, 0.043, 0.107),
        [Cylinder("z", -0.059, 0.048, 0.043), Cylinder("y", -0.0565, 0.0, 0.043)],
        "link4",
    ),
    Link(
        "arm6_link5",
        1.3,
        (0.0, 0.01634, -0.0018),
        _rod("z", 1.3, 0.043, 0.09),
        [Cylinder("z", -0.042, 0.048, 0.043), Cylinder("y", 0.0, 0.0545, 0.043)],
        "link5",
    ),
    Link(
        "arm6_link6",
        0.365,
        (0.0, 0.0, -0.001159),
        _rod("z", 0.365, 0.0375, 0.044),
        [Cylinder("z", -0.044, 0.0, 0.040)],
        "link6",
    ),
    Link(
        "arm6_hand",
        0.80,
        (0.0, 0.0, 0.042),
        _block(0.80, 0.07, 0.15, 0.075),
        [Cylinder("z", 0.0, 0.020, 0.040), Box((-0.036, -0.078, 0.016), (0.036, 0.078, 0.0795))],
        "hand",
    ),
    Link("arm6_leftfinger", 0.06, (0.0, 0.011, 0.026), FINGER_INERTIA, FINGER, "finger", contact=GRIP),
    Link("arm6_rightfinger", 0.06, (0.0, -0.011, 0.026), FINGER_INERTIA, FINGER, "finger", turned=True, contact=GRIP),
    Link("arm6_grasptarget"),
]


def _arm(number: int, xyz: Vec3, rpy: Vec3, range_: float, effort: float) -> Joint:
    names = (f"arm6_joint{number}", "revolute", f"arm6_link{number - 1}", f"arm6_link{number}")
    return Joint(*names, xyz, rpy, UP, (-range_, range_, effort, math.pi))


def _finger(number: int, side: str, sign: float, mimic: str = "") -> Joint:
    names = (f"arm6_finger_joint{number}", "prismatic", "arm6_hand", f"arm6_{side}finger")
    return Joint(*names, (0.0, 0.0, FINGER_BASE), ZERO, (0.0, sign, 0.0), (0.0, STROKE, 235.0, 0.15), mimic)


JOINTS: list[Joint] = [
    _arm(1, (0.0, 0.0, D1), (0.0, 0.0, math.pi), 2 * math.pi, 150.0),
    _arm(2, ZERO, (HALF_PI, 0.0, 0.0), 2 * math.pi, 150.0),
    _arm(3, (A2, 0.0, 0.0), ZERO, math.pi, 150.0),
    _arm(4, (A3, 0.0, D4), ZERO, 2 * math.pi, 28.0),
    _arm(5, (0.0, -D5, 0.0), (HALF_PI, 0.0, 0.0), 2 * math.pi, 28.0),
    _arm(6, (0.0, D6, 0.0), (-HALF_PI, 0.0, 0.0), 2 * math.pi, 28.0),
    Joint("arm6_hand_joint", "fixed", "arm6_link6", "arm6_hand", ZERO, (0.0, 0.0, -HALF_PI)),
    _finger(1, "left", 1.0),
    _finger(2, "right", -1.0, mimic="arm6_finger_joint1"),
    Joint("arm6_grasptarget_hand", "fixed", "arm6_hand", "arm6_grasptarget", (0.0, 0.0, TARGET)),
]

ARM6 = Robot("arm6", "tools/make_arm6.py", MATERIALS, LINKS, JOINTS, SHELLS)
