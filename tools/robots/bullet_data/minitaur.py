"""A Minitaur: eight motors turn the upper halves of four pairs of bars, whose lower ends programs tie together."""

from __future__ import annotations

from dataclasses import dataclass

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import ZERO, Cylinder, Joint, Link, Shape, Vec3

Looks = list[tuple[Shape, str]]
TURN, HALF_TURN = 1.57075, 3.141592
DRIVE = (100.0, 100.0)
Z: Vec3 = (0.0, 0.0, 1.0)
FOOT = {"stiffness": 10000.0, "damping": 10.0, "lateral_friction": 1.0}
MOTOR: list[Shape] = [Cylinder("z", -0.013, 0.013, 0.0434)]
ROTOR: Looks = [(Cylinder("z", -0.0145, 0.0145, 0.030), "graphite"), (Cylinder("z", -0.016, 0.016, 0.008), "accent")]


@dataclass(frozen=True)
class Shin:
    """A bar that hangs on a knee, and reaches from it by its length. Constraints measure from its centre of mass."""

    size: Vec3
    mass: float
    com: float


@dataclass(frozen=True)
class Build:
    """How one of them differs from the others."""

    base: Link
    sides: list[Link]
    side_xyz: tuple[Vec3, Vec3]  # right, left
    side_roll: tuple[float, float]
    motor_x: float
    motor_y: dict[str, float]  # by left or right and the bar: rightR ...
    hip: Vec3
    knee: Vec3
    upper: Vec3  # size of the bars that motors turn
    shins: tuple[Shin, Shin]  # outside and inside
    masses: tuple[float, float]  # motor, upper bar
    plain_names: bool  # hip_front_rightR_joint rather than the first model's


ORDER = [
    "front_rightR",
    "front_rightL",
    "back_rightR",
    "back_rightL",
    "front_leftL",
    "front_leftR",
    "back_leftL",
    "back_leftR",
]


def _hip_name(leg: str, plain: bool) -> tuple[str, str]:
    """Names of the joints that hold the upper bar and the knee."""
    if plain:
        return f"hip_{leg}_joint", f"knee_{leg}_joint"
    held = f"motor_{leg}_link" if leg.endswith("L") else f"hip_{leg.replace('back_', '')}_link"
    return held, f"knee_{leg}_link"


def _legs(build: Build) -> tuple[list[Link], list[Joint]]:
    links, joints = [], []
    for leg in ORDER:
        end, pair = leg.split("_")
        side = pair[:-1]
        x = build.motor_x if end == "front" else -build.motor_x
        yaw = HALF_TURN if pair.endswith("L") else 0.0
        motor, upper, lower = (f"{part}_{leg}_link" for part in ("motor", "upper_leg", "lower_leg"))
        hip, knee = _hip_name(leg, build.plain_names)
        h = build.upper[2] / 2
        shin = build.shins[1 if pair in ("rightL", "leftR") else 0]
        length = shin.size[2]
        bar: list[Shape] = [box(*build.upper)]
        pin: Looks = [(Cylinder("y", -0.008, 0.014, 0.008, (0, 0, h)), "accent")]
        rod: list[Shape] = [box(*shin.size, (0, 0, length / 2))]
        ankle: Looks = [(Cylinder("y", -0.007, 0.007, 0.009, (0, 0, length)), "graphite")]
        links += [
            solid(motor, build.masses[0], MOTOR, "metal", looks=ROTOR),
            solid(upper, build.masses[1], bar, "slate", looks=pin, com=ZERO),
            solid(lower, shin.mass, rod, "shell", looks=ankle, com=(0, 0, shin.com), contact=FOOT),
        ]
        joints += [
            Joint(
                f"motor_{leg}_joint",
                "continuous",
                f"chassis_{side}",
                motor,
                (x, build.motor_y[pair], 0),
                (TURN, 0, yaw),
                Z,
                drive=DRIVE,
            ),
            Joint(hip, "fixed", motor, upper, build.hip, (-TURN, 0, 0), drive=DRIVE),
            Joint(knee, "continuous", upper, lower, build.knee, ZERO, (0, 1, 0), drive=DRIVE),
        ]
    return links, joints


def _robot(path: str, build: Build) -> Files:
    links, joints = _legs(build)
    centres = []
    for side, xyz, roll in zip(("right", "left"), build.side_xyz, build.side_roll, strict=True):
        name = f"chassis_{side}"
        centres.append(Joint(f"{name}_center", "fixed", "base_chassis_link", name, xyz, (roll, 0, 0), drive=DRIVE))
    return place(path, model("quadruped", [build.base, *build.sides, *links], [*centres, *joints]))


def _beams(length: float, mass: float, y: float) -> list[Link]:
    bars: list[Shape] = [box(length, 0.01, 0.04, (0, s * y, 0)) for s in (1, -1)]
    return [solid(f"chassis_{side}", mass, bars, "metal", com=ZERO) for side in ("right", "left")]


def _sketch() -> Files:
    """The first of the family: motors straight on the chassis, bars without yaw."""
    deck: Looks = [
        (box(0.24, 0.08, 0.012, (0, 0, 0.041)), "graphite"),
        (box(0.05, 0.06, 0.014, (0.10, 0, 0.043)), "teal"),
    ]
    hull: list[Shape] = [box(0.33, 0.10, 0.07), *(box(0.10, 0.18, 0.05, (s * 0.21, 0, 0)) for s in (1, -1))]
    links, joints = [solid("base_chassis_link", 3.2, hull, "slate", looks=deck, com=ZERO)], []
    lateral = {"rightR": -0.125, "rightL": -0.06, "leftR": 0.125, "leftL": 0.06}
    for leg in (f"{end}_{pair}" for end in ("front", "back") for pair in lateral):
        end, pair = leg.split("_")
        motor, upper, lower = (f"{part}_{leg}_link" for part in ("motor", "upper_leg", "lower_leg"))
        hip, knee = _hip_name(leg, plain=False)
        outwards = -0.02 if pair in ("rightR", "leftL") else 0.02
        at = (0.21 if end == "front" else -0.21, lateral[pair], 0.0)
        links += [
            solid(motor, 0.25, MOTOR, "metal", looks=ROTOR),
            solid(upper, 0.05, [box(0.01, 0.01, 0.11)], "slate"),
            solid(lower, 0.05, [box(0.01, 0.01, 0.2, (0, 0, 0.1))], "shell", com=ZERO, contact=FOOT),
        ]
        joints += [
            Joint(f"motor_{leg}_joint", "continuous", "base_chassis_link", motor, at, (TURN, 0, 0), Z, drive=DRIVE),
            Joint(hip, "fixed", motor, upper, (0, 0.06, outwards), (-TURN, 0, 0), drive=DRIVE),
            Joint(knee, "continuous", upper, lower, (0, 0, 0.055), ZERO, (0, 1, 0), drive=DRIVE),
        ]
    return place("quadruped/quadruped.urdf", model("quadruped", links, joints))


def files() -> Files:
    hull: list[Shape] = [box(0.33, 0.10, 0.07), *(box(0.17, 0.10, 0.05, (0, s * 0.10, 0)) for s in (1, -1))]
    top: Looks = [
        (box(0.24, 0.08, 0.012, (0, 0, 0.041)), "graphite"),
        (box(0.05, 0.06, 0.014, (0.10, 0, 0.043)), "accent"),
    ]
    first = Build(
        base=solid("base_chassis_link", 3.0, hull, "slate", looks=top, com=ZERO),
        sides=_beams(0.34, 0.1, 0.035),
        side_xyz=((0.0, -0.10, 0.0), (0.0, 0.10, 0.0)),
        side_roll=(-0.0872665, 0.0872665),
        motor_x=0.21,
        motor_y={"rightR": -0.025, "rightL": 0.04, "leftL": 0.025, "leftR": -0.04},
        hip=(0.0, 0.06, -0.015),
        knee=(0.0, 0.01, 0.055),
        upper=(0.01, 0.01, 0.11),
        shins=(Shin((0.01, 0.01, 0.2), 0.05, 0.0), Shin((0.01, 0.01, 0.2), 0.05, 0.0)),
        masses=(0.25, 0.05),
        plain_names=False,
    )
    trunk: list[Shape] = [box(0.30, 0.13, 0.087, (0, 0, 0))]
    cover: Looks = [
        (box(0.26, 0.10, 0.05, (0.02, 0, 0.065)), "teal"),
        (box(0.10, 0.11, 0.03, (0.05, 0, 0.10)), "graphite"),
    ]
    second = Build(
        base=solid("base_chassis_link", 3.353, trunk, "slate", looks=cover, com=(0.05, 0.0, 0.0)),
        sides=_beams(0.54, 1.32, 0.054),
        side_xyz=((0.0, -0.1265, -0.0185), (0.0, 0.1265, -0.0185)),
        side_roll=(0.0, 0.0),
        motor_x=0.2375,
        motor_y={"rightR": -0.0275, "rightL": 0.0275, "leftL": 0.0275, "leftR": -0.0275},
        hip=(0.0, 0.045, -0.0145),
        knee=(0.0, 0.0085, 0.056),
        upper=(0.039, 0.008, 0.129),
        shins=(Shin((0.017, 0.009, 0.24), 0.086, 0.12), Shin((0.017, 0.009, 0.216), 0.072, 0.1)),
        masses=(0.072, 0.034),
        plain_names=True,
    )
    bulk: list[Shape] = [box(0.295, 0.142, 0.078)]
    deck: Looks = [
        (box(0.25, 0.11, 0.012, (0, 0, 0.045)), "accent"),
        (box(0.08, 0.08, 0.02, (0.06, 0, 0.05)), "graphite"),
    ]
    third = Build(
        base=solid("base_chassis_link", 1.81246, bulk, "slate", looks=deck, com=(0.05, 0.0, 0.0)),
        sides=_beams(0.46, 1.3668, 0.0455),
        side_xyz=((0.0, -0.1165, -0.011), (0.0, 0.1165, -0.011)),
        side_roll=(-0.0872665, 0.0872665),
        motor_x=0.20268,
        motor_y={"rightR": -0.03275, "rightL": 0.03275, "leftL": 0.03275, "leftR": -0.03275},
        hip=(0.0, 0.045, -0.01725),
        knee=(0.0, 0.01, 0.056),
        upper=(0.039, 0.0064, 0.129),
        shins=(Shin((0.017, 0.0064, 0.24), 0.066, 0.12), Shin((0.017, 0.0064, 0.216), 0.055, 0.1)),
        masses=(0.241, 0.026),
        plain_names=True,
    )
    return {
        **_robot("quadruped/minitaur.urdf", first),
        **_robot("quadruped/minitaur_rainbow_dash.urdf", second),
        **_robot("quadruped/minitaur_derpy.urdf", third),
        **_sketch(),
    }
