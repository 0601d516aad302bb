"""Arms of six and seven axes, each straight up at zero angles, with all link frames parallel there.

Reaches, limits, torques and speeds are about those that makers publish of arms of each kind; shapes are our own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from robots.collection.common import Entry, Part, frame, link, robot
from robots.description import HALF_PI, UP, ZERO, Cylinder, Joint, Shape, Sphere, Vec3

Y: Vec3 = (0.0, 1.0, 0.0)
TURN, ALMOST = 2 * math.pi, 0.95 * math.pi


@dataclass(frozen=True)
class Axis:
    """A joint at `xyz` of the link before, what it may do, and the parts of its link."""

    xyz: Vec3
    axis: Vec3
    reach: float  # rad, to both sides
    effort: float
    velocity: float
    parts: list[Part]


def drive(shape: Shape, colour: str = "shell") -> Part:
    return Part(shape, "drive", colour)


def tube(shape: Shape, colour: str = "shell") -> Part:
    return Part(shape, "tube", colour)


def ring(axis: str, at: float, radius: float, centre: Vec3 = ZERO, colour: str = "teal") -> Part:
    """A band that is seen where two links meet."""
    return Part(Cylinder(axis, at - 0.004, at + 0.004, radius, centre), "plastic", colour, seen_only=True)


def hub(half: float, radius: float, z: float = 0.0) -> Part:
    """The housing of a drive about a y axis."""
    return drive(Cylinder("y", -half, half, radius, (0, 0, z)))


def caps(half: float, radius: float, colour: str, z: float = 0.0) -> list[Part]:
    """What closes a hub at both ends."""
    return [ring("y", side * half, 0.8 * radius, (0, 0, z), colour) for side in (-1, 1)]


def arm(
    name: str,
    about: str,
    base: list[Part],
    axes: list[Axis],
    flange: tuple[Vec3, Vec3],
    home: list[float],
    payload: float,
) -> Entry:
    """Links base, link1, ...; joints joint1, ...; a frame `flange` on the last one, at a position and rpy."""
    links, joints = [link("base", base)], []
    for k, axis in enumerate(axes, 1):
        links.append(link(f"link{k}", axis.parts))
        limits = (-axis.reach, axis.reach, axis.effort, axis.velocity)
        joints.append(Joint(f"joint{k}", "revolute", links[k - 1].name, f"link{k}", axis.xyz, ZERO, axis.axis, limits))
    end, mount = frame("flange", links[-1].name, *flange)
    posture = {joint.name: round(angle, 6) for joint, angle in zip(joints, home, strict=True)}
    return Entry(robot(name, [*links, end], [*joints, mount]), "arm", about, posture, "flange", payload=payload)


def six_axis() -> Entry:
    """Three parallel axes and an offset wrist; the tool points along y at zero angles."""
    base = [
        drive(Cylinder("z", 0.0, 0.02, 0.085), "slate"),
        drive(Cylinder("z", 0.02, 0.092, 0.066)),
        ring("z", 0.09, 0.067),
    ]
    axes = [
        Axis(
            (0, 0, 0.0925),
            UP,
            TURN,
            150,
            math.pi,
            [drive(Cylinder("z", 0.0, 0.07, 0.062)), hub(0.064, 0.062, 0.07), *caps(0.064, 0.062, "teal", 0.07)],
        ),
        Axis(
            (0, 0.130, 0.070),
            Y,
            TURN,
            150,
            math.pi,
            [
                hub(0.062, 0.060),
                tube(Cylinder("z", 0.0, 0.425, 0.048)),
                hub(0.056, 0.054, 0.425),
                *caps(0.062, 0.06, "teal"),
                *caps(0.056, 0.054, "teal", 0.425),
            ],
        ),
        Axis(
            (0, -0.112, 0.425),
            Y,
            ALMOST,
            150,
            math.pi,
            [hub(0.052, 0.052), tube(Cylinder("z", 0.0, 0.392, 0.040)), *caps(0.052, 0.052, "teal")],
        ),
        Axis(
            (0, 0.0, 0.392),
            Y,
            TURN,
            28,
            math.pi,
            [hub(0.048, 0.043), drive(Cylinder("z", 0.0, 0.046, 0.042)), *caps(0.048, 0.043, "teal")],
        ),
        Axis(
            (0, 0.0, 0.0997),
            UP,
            TURN,
            28,
            math.pi,
            [
                drive(Cylinder("z", -0.050, 0.048, 0.042)),
                drive(Cylinder("y", 0.0, 0.050, 0.040)),
                ring("z", 0.048, 0.034),
            ],
        ),
        Axis((0, 0.0536, 0), Y, TURN, 28, math.pi, [drive(Cylinder("y", 0.0, 0.046, 0.0375), "metal")]),
    ]
    home = [0.0, 0.1, 1.7, HALF_PI - 1.8, -HALF_PI, 0.0]
    return arm(
        "six_axis",
        "collaborative arm of six axes with an offset wrist, of the UR5e's class",
        base,
        axes,
        ((0, 0.046, 0), (-HALF_PI, 0, 0)),
        home,
        5.0,
    )


def six_axis_compact() -> Entry:
    """An elbow set forward, and a wrist whose last axis is in line with the forearm."""
    base = [
        drive(Cylinder("z", 0.0, 0.03, 0.066), "slate"),
        drive(Cylinder("z", 0.03, 0.19, 0.052)),
        ring("z", 0.188, 0.053, colour="accent"),
    ]
    axes = [
        Axis(
            (0, 0, 0.192),
            UP,
            TURN,
            50,
            math.pi,
            [drive(Cylinder("z", 0.0, 0.075, 0.050)), hub(0.050, 0.050, 0.075), *caps(0.05, 0.05, "graphite", 0.075)],
        ),
        Axis(
            (0, 0.098, 0.075),
            Y,
            2.05,
            50,
            math.pi,
            [
                hub(0.046, 0.050),
                tube(Cylinder("z", 0.0, 0.285, 0.040)),
                hub(0.046, 0.048, 0.285),
                *caps(0.046, 0.05, "graphite"),
                *caps(0.046, 0.048, "graphite", 0.285),
            ],
        ),
        Axis(
            (0, -0.090, 0.285),
            Y,
            2.6,
            32,
            math.pi,
            [
                hub(0.042, 0.046),
                tube(Cylinder("x", 0.0, 0.0775, 0.036)),
                drive(Cylinder("z", 0.0, 0.13, 0.042, (0.0775, 0, 0))),
                ring("z", 0.128, 0.043, (0.0775, 0, 0), "accent"),
            ],
        ),
        Axis(
            (0.0775, 0, 0.132),
            UP,
            TURN,
            32,
            math.pi,
            [tube(Cylinder("z", 0.0, 0.17, 0.039)), hub(0.040, 0.040, 0.2025), *caps(0.04, 0.04, "graphite", 0.2025)],
        ),
        Axis(
            (0, 0.078, 0.2025),
            Y,
            2.2,
            20,
            math.pi,
            [hub(0.036, 0.038), drive(Cylinder("z", 0.0, 0.075, 0.038)), *caps(0.036, 0.038, "graphite")],
        ),
        Axis((0, 0, 0.077), UP, TURN, 20, math.pi, [drive(Cylinder("z", 0.0, 0.020, 0.0375), "metal")]),
    ]
    home = [0.0, -0.35, 1.75, 0.0, math.pi - 1.40, 0.0]
    return arm(
        "six_axis_compact",
        "light arm of six axes with its elbow set forward, of the xArm6's class",
        base,
        axes,
        ((0, 0, 0.020), ZERO),
        home,
        2.5,
    )


def six_axis_slim() -> Entry:
    """Slender links that stand beside each other at shoulder and elbow."""
    base = [drive(Cylinder("z", 0.0, 0.014, 0.060), "slate"), drive(Cylinder("z", 0.014, 0.154, 0.045), "slate")]
    axes = [
        Axis(
            (0, 0, 0.156),
            UP,
            TURN,
            54,
            1.4,
            [
                drive(Cylinder("z", 0.0, 0.128, 0.044), "slate"),
                hub(0.046, 0.044, 0.128),
                *caps(0.046, 0.044, "metal", 0.128),
            ],
        ),
        Axis(
            (0, 0.084, 0.128),
            Y,
            2.41,
            54,
            1.4,
            [
                drive(Cylinder("y", -0.036, 0.036, 0.044), "slate"),
                tube(Cylinder("z", 0.0, 0.41, 0.035), "slate"),
                drive(Cylinder("y", -0.036, 0.036, 0.042, (0, 0, 0.41)), "slate"),
                *caps(0.036, 0.044, "metal"),
                *caps(0.036, 0.042, "metal", 0.41),
            ],
        ),
        Axis(
            (0, -0.074, 0.41),
            Y,
            2.66,
            54,
            1.4,
            [
                drive(Cylinder("y", -0.036, 0.036, 0.042), "slate"),
                tube(Cylinder("z", 0.0, 0.205, 0.036), "slate"),
                *caps(0.036, 0.042, "metal"),
            ],
        ),
        Axis(
            (0, 0, 0.208),
            UP,
            TURN,
            20,
            1.2,
            [
                drive(Cylinder("z", 0.0, 0.106, 0.034), "slate"),
                drive(Cylinder("y", -0.034, 0.034, 0.034, (0, 0, 0.106)), "slate"),
                ring("z", 0.004, 0.036, colour="metal"),
            ],
        ),
        Axis(
            (0, 0.064, 0.106),
            Y,
            2.23,
            20,
            1.2,
            [
                drive(Cylinder("y", -0.028, 0.028, 0.033), "slate"),
                drive(Cylinder("z", 0.0, 0.104, 0.033), "slate"),
                *caps(0.028, 0.033, "metal"),
            ],
        ),
        Axis(
            (0, 0, 0.106),
            UP,
            TURN,
            20,
            1.2,
            [drive(Cylinder("z", 0.0, 0.060, 0.033), "slate"), ring("z", 0.004, 0.034, colour="metal")],
        ),
    ]
    home = [0.0, -0.20, 1.9, 0.0, math.pi - 1.70, 0.0]
    return arm(
        "six_axis_slim",
        "slender arm of six axes for wheelchairs and mobile bases, of the Gen3's class",
        base,
        axes,
        ((0, 0, 0.0615), ZERO),
        home,
        2.0,
    )


def seven_axis() -> Entry:
    """A round shoulder, elbow and wrist: three axes each meet in a point, but for the elbow's two."""

    def roll(z: float, effort: float, velocity: float, length: float, radius: float, reach: float = 2.96) -> Axis:
        parts = [
            tube(Cylinder("z", radius, length, radius)),
            tube(Sphere(radius, (0, 0, length))),
            drive(Cylinder("z", 0.0, radius, radius)),
            ring("z", 0.006, radius + 0.001, colour="accent"),
        ]
        return Axis((0, 0, z), UP, reach, effort, velocity, parts)

    def pitch(z: float, effort: float, velocity: float, radius: float, length: float) -> Axis:
        parts = [
            hub(radius + 0.014, 0.78 * radius),
            tube(Cylinder("z", 0.0, length, 0.88 * radius)),
            *caps(radius + 0.014, 0.7 * radius, "slate"),
        ]
        return Axis((0, 0, z), Y, 2.09, effort, velocity, parts)

    base = [drive(Cylinder("z", 0.0, 0.03, 0.090), "slate"), tube(Cylinder("z", 0.03, 0.148, 0.072))]
    axes = [
        roll(0.15, 176, 1.71, 0.19, 0.066),
        pitch(0.19, 176, 1.71, 0.066, 0.21),
        roll(0.21, 110, 1.75, 0.19, 0.060),
        pitch(0.19, 110, 2.27, 0.060, 0.21),
        roll(0.21, 110, 2.44, 0.19, 0.052),
        Axis(
            (0, 0, 0.19),
            Y,
            2.09,
            40,
            3.14,
            [hub(0.062, 0.046), drive(Cylinder("z", 0.0, 0.078, 0.042)), *caps(0.062, 0.040, "slate")],
        ),
        Axis((0, 0, 0.081), UP, 3.05, 40, 3.14, [drive(Cylinder("z", 0.0, 0.045, 0.040), "metal")]),
    ]
    home = [0.0, 0.35, 0.0, 1.75, 0.0, math.pi - 2.10, 0.0]
    return arm(
        "seven_axis",
        "arm of seven axes with round joints, of the LBR iiwa's class",
        base,
        axes,
        ((0, 0, 0.045), ZERO),
        home,
        7.0,
    )


def entries() -> list[Entry]:
    return [six_axis(), six_axis_compact(), six_axis_slim(), seven_axis()]
