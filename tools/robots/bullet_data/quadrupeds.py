"""Dogs: a Laikago, an A1 and a Mini Cheetah. Legs are made by sides: fore and hind, right and left."""

from __future__ import annotations

import math
from dataclasses import replace

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import HALF_PI, ZERO, Capsule, Cylinder, Joint, Link, Placed, Shape, Sphere, Vec3

Looks = list[tuple[Shape, str]]
DRIVE = (100.0, 100.0)
X: Vec3 = (1.0, 0.0, 0.0)
Y: Vec3 = (0.0, 1.0, 0.0)
SOLE = {"stiffness": 30000.0, "damping": 1000.0, "spinning_friction": 0.1, "lateral_friction": 1.0}
QUARTER = 1.57079  # of the file that this stands in for


def _between(a: Vec3, b: Vec3, radius: float) -> Placed:
    """Capsule from a to b in a plane x = const, of legs that hang along -y or -z."""
    middle = tuple(round((p + q) / 2, 6) for p, q in zip(a, b, strict=True))
    dy, dz = b[1] - a[1], b[2] - a[2]
    half = round(math.hypot(dy, dz) / 2, 6)
    roll = round(math.atan2(-dy, dz), 9)
    return Placed(Capsule("z", -half, half, radius), (middle[0], middle[1], middle[2]), (roll, 0.0, 0.0))


def _laikago_leg(leg: str, toes: bool) -> tuple[list[Link], list[Joint]]:
    """It hangs along -y; the upper leg leans back towards -z, the lower stands upright."""
    s = 1.0 if leg[1] == "L" else -1.0
    rough = {"lateral_friction": 1.0}
    motor: list[Shape] = [
        Cylinder("x", min(0.0, -s * 0.045), max(0.0, -s * 0.045), 0.046),
        Cylinder("z", -0.035, 0.035, 0.040),
    ]
    cap: Looks = [(Cylinder("x", min(s * 0.012, s * 0.028), max(s * 0.012, s * 0.028), 0.044), "slate")]
    links = [solid(f"{leg}_hip_motor", 1.095, motor, "shell", looks=cap, com=(-s * 0.02, 0, 0), contact=rough)]
    knee: Vec3 = (-s * 0.02069, -0.20833, -0.1422)
    inner: Vec3 = (-s * 0.012, 0.0, 0.0)
    thigh: list[Shape] = [_between(inner, (inner[0], knee[1], knee[2]), 0.032)]
    thigh.append(Cylinder("x", -0.036, 0.036, 0.052))
    disc: Looks = [(Cylinder("x", min(s * 0.034, s * 0.042), max(s * 0.034, s * 0.042), 0.040), "graphite")]
    disc.append((Cylinder("x", min(s * 0.041, s * 0.044), max(s * 0.041, s * 0.044), 0.016), "accent"))
    links.append(solid(f"{leg}_upper_leg", 1.527, thigh, "shell", looks=disc, com=(0, -0.04, -0.04), contact=rough))
    toe: Vec3 = (0.0, -0.25, -0.022)
    shin: list[Shape] = [_between(ZERO, toe, 0.015)]
    joint: Looks = [(Cylinder("x", -0.026, 0.026, 0.024), "graphite")]
    links.append(solid(f"{leg}_lower_leg", 0.241, shin, "slate", looks=joint, com=(0, -0.16, -0.02), contact=rough))
    front, left = leg[0] == "F", s > 0
    hip: Vec3 = (s * 0.0817145, 0.0, 0.242889 if front else -0.194401)
    side: Vec3 = (0.055855, 0.0, 0.0) if left else (-0.053565, 0.0, 0.0)
    joints = [
        Joint(
            f"{leg}_hip_motor_2_chassis_joint",
            "continuous",
            "chassis",
            f"{leg}_hip_motor",
            hip,
            ZERO,
            (0.0, 0.0, s),
            drive=DRIVE,
        ),
        Joint(
            f"{leg}_upper_leg_2_hip_motor_joint",
            "continuous",
            f"{leg}_hip_motor",
            f"{leg}_upper_leg",
            side,
            ZERO,
            X,
            drive=DRIVE,
        ),
        Joint(
            f"{leg}_lower_leg_2_upper_leg_joint",
            "continuous",
            f"{leg}_upper_leg",
            f"{leg}_lower_leg",
            knee,
            ZERO,
            X,
            drive=DRIVE,
        ),
    ]
    if toes:
        links.append(solid(f"toe{leg}", 0.1, [Sphere(0.03)], "graphite", contact=SOLE))
        joints.append(Joint(f"jtoe{leg}", "fixed", f"{leg}_lower_leg", f"toe{leg}", toe))
    return links, joints


def _laikago_trunk(upright: bool) -> Link:
    """Its long axis is z and y points up, or x and z where it stands `upright`."""
    size = (0.18, 0.13, 0.50)
    at: Vec3 = (0.0, 0.03, 0.024)
    if upright:
        bulk, com = box(size[2], size[0], size[1], (-0.02, 0.0, 0.0)), ZERO
        tops: Looks = [
            (box(0.42, 0.12, 0.02, (-0.02, 0, 0.07)), "slate"),
            (box(0.05, 0.15, 0.07, (0.245, 0, 0.01)), "graphite"),
        ]
        tops.append((Cylinder("x", 0.26, 0.275, 0.018, (0, 0.04, 0.015)), "sky"))
        tops.append((Cylinder("x", 0.26, 0.275, 0.018, (0, -0.04, 0.015)), "sky"))
    else:
        bulk, com = box(*size, at), (0.0, 0.03, 0.043794)
        tops = [
            (box(0.12, 0.02, 0.42, (0, 0.10, 0.024)), "slate"),
            (box(0.15, 0.07, 0.05, (0, 0.04, 0.289)), "graphite"),
        ]
        tops += [(Cylinder("z", 0.31, 0.319, 0.018, (x, 0.045, 0)), "sky") for x in (-0.04, 0.04)]
    return solid("chassis", 13.715, [bulk], "shell", looks=tops, com=com, contact={"lateral_friction": 1.0})


def _laikago(toes: bool, upright: bool) -> tuple[list[Link], list[Joint]]:
    links, joints = [_laikago_trunk(upright)], []
    for leg in ("FR", "FL", "RR", "RL"):
        more, hung = _laikago_leg(leg, toes)
        if upright:
            s = 1.0 if leg[1] == "L" else -1.0
            hip = (0.199095 if leg[0] == "F" else -0.238195, s * 0.0817145, -0.03)
            hung[0] = replace(hung[0], xyz=hip, rpy=(QUARTER, 0.0, QUARTER))
        links += more
        joints += hung
    return links, joints


def _laikagos() -> Files:
    return {
        **place("laikago/laikago.urdf", model("plane", *_laikago(False, False))),
        **place("laikago/laikago_toes.urdf", model("plane", *_laikago(True, False))),
        **place("laikago/laikago_toes_zup.urdf", model("plane", *_laikago(True, True))),
    }


def _a1() -> Files:
    face: Looks = [
        (box(0.03, 0.10, 0.05, (0.145, 0, 0.0)), "graphite"),
        (box(0.004, 0.06, 0.012, (0.161, 0, 0.005)), "sky"),
    ]
    face += [(box(0.20, 0.12, 0.012, (0, 0, 0.060)), "slate"), (box(0.22, 0.198, 0.030, (0, 0, -0.02)), "graphite")]
    trunk = solid("trunk", 4.713, [box(0.267, 0.194, 0.114)], "accent", looks=face, com=(0.012731, 0.002186, 0.000515))
    speck: list[Shape] = [box(0.001, 0.001, 0.001)]
    links = [trunk, solid("imu_link", 0.001, speck, "red", like=[box(0.02, 0.02, 0.02)])]
    joints = [Joint("imu_joint", "fixed", "trunk", "imu_link", ZERO)]
    for leg in ("FR", "FL", "RR", "RL"):
        f, s = (1.0 if leg[0] == "F" else -1.0), (1.0 if leg[1] == "L" else -1.0)
        hub: list[Shape] = [Cylinder("y", -0.02, 0.02, 0.046)]
        ring: Looks = [(Cylinder("x", -0.052, 0.052, 0.030), "slate")]
        links.append(solid(f"{leg}_hip", 0.696, hub, "graphite", looks=ring, com=(-f * 0.003311, s * 0.000635, 3.1e-5)))
        shoulder: list[Shape] = [Cylinder("y", -0.016, 0.016, 0.041)]
        links.append(solid(f"{leg}_upper_shoulder", 0.001, shoulder, "slate"))
        thigh: list[Shape] = [Placed(box(0.2, 0.0245, 0.034), (0, 0, -0.1), (0, HALF_PI, 0))]
        skin: Looks = [
            (Capsule("z", -0.185, -0.012, 0.021), "accent"),
            (Cylinder("y", -0.024, 0.024, 0.040), "graphite"),
        ]
        links.append(solid(f"{leg}_upper", 1.013, thigh, looks=skin, com=(-0.003237, -s * 0.022327, -0.027326)))
        calf: list[Shape] = [Placed(box(0.2, 0.016, 0.016), (0, 0, -0.1), (0, HALF_PI, 0))]
        bone: Looks = [(Capsule("z", -0.19, 0.0, 0.009), "graphite"), (Cylinder("y", -0.016, 0.016, 0.018), "slate")]
        links.append(solid(f"{leg}_lower", 0.166, calf, looks=bone, com=(0.006435, 0, -0.107388)))
        links.append(solid(f"{leg}_toe", 0.06, [Sphere(0.02)], "slate"))
        joints += [
            Joint(
                f"{leg}_hip_joint",
                "revolute",
                "trunk",
                f"{leg}_hip",
                (f * 0.183, s * 0.047, 0),
                ZERO,
                X,
                (-0.802851455917, 0.802851455917, 20.0, 52.4),
            ),
            Joint(f"{leg}_hip_fixed", "fixed", f"{leg}_hip", f"{leg}_upper_shoulder", (0, s * 0.081, 0)),
            Joint(
                f"{leg}_upper_joint",
                "revolute",
                f"{leg}_hip",
                f"{leg}_upper",
                (0, s * 0.08505, 0),
                ZERO,
                Y,
                (-1.0471975512, 4.18879020479, 55.0, 28.6),
            ),
            Joint(
                f"{leg}_lower_joint",
                "revolute",
                f"{leg}_upper",
                f"{leg}_lower",
                (0, 0, -0.2),
                ZERO,
                Y,
                (-2.69653369433, -0.916297857297, 55.0, 28.6),
            ),
            Joint(f"{leg}_toe_fixed", "fixed", f"{leg}_lower", f"{leg}_toe", (0, 0, -0.2)),
        ]
    return place("a1/a1.urdf", model("a1_description", links, joints))


def _cheetah() -> Files:
    face: Looks = [(box(0.30, 0.09, 0.014, (0, 0, 0.054)), "teal"), (box(0.012, 0.10, 0.05, (0.166, 0, 0)), "graphite")]
    body = solid("body", 3.3, [box(0.33, 0.16, 0.10)], "shell", looks=face, com=ZERO)
    links, joints = [body], []
    foot = {"stiffness": 30000.0, "damping": 1000.0, "spinning_friction": 0.3, "lateral_friction": 3.0}
    for leg in ("fr", "fl", "hr", "hl"):
        f, s = (1.0 if leg[0] == "f" else -1.0), (1.0 if leg[1] == "l" else -1.0)
        hub: list[Shape] = [
            Cylinder("x", -0.030, 0.030, 0.040),
            Cylinder("y", min(0, s * 0.045), max(0, s * 0.045), 0.036),
        ]
        links.append(solid(f"abduct_{leg}", 0.54, hub, "graphite", com=(0, 0.036, 0)))
        thigh: list[Shape] = [Capsule("z", -0.209, 0.0, 0.022)]
        rotor: Looks = [(Cylinder("y", -0.024, 0.024, 0.048), "slate"), (Cylinder("y", -0.026, 0.026, 0.020), "teal")]
        links.append(solid(f"thigh_{leg}", 0.634, thigh, "shell", looks=rotor, com=(0, 0.016, -0.02)))
        shank: list[Shape] = [Capsule("z", -0.18, 0.0, 0.010)]
        links.append(solid(f"shank_{leg}", 0.064, shank, "graphite", com=(0, 0, -0.209)))
        links.append(solid(f"toe_{leg}", 0.15, [Sphere(0.015)], "slate", contact=foot))
        back: Vec3 = (0.0, -1.0, 0.0)
        joints += [
            Joint(f"torso_to_abduct_{leg}_j", "continuous", "body", f"abduct_{leg}", (f * 0.19, s * 0.049, 0), ZERO, X),
            Joint(
                f"abduct_{leg}_to_thigh_{leg}_j",
                "continuous",
                f"abduct_{leg}",
                f"thigh_{leg}",
                (0, s * 0.062, 0),
                ZERO,
                back,
            ),
            Joint(
                f"thigh_{leg}_to_knee_{leg}_j", "continuous", f"thigh_{leg}", f"shank_{leg}", (0, 0, -0.209), ZERO, back
            ),
            Joint(f"toe_{leg}_joint", "fixed", f"shank_{leg}", f"toe_{leg}", (0, 0, -0.18)),
        ]
    return place("mini_cheetah/mini_cheetah.urdf", model("mini_cheetah", links, joints))


def files() -> Files:
    return {**_laikagos(), **_a1(), **_cheetah()}
