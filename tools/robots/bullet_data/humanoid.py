"""A person of capsules and balls four times life size, y up, with ball joints: the body that motion clips move."""

from __future__ import annotations

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import ZERO, Capsule, Cylinder, Joint, Link, Shape, Sphere, Vec3

Looks = list[tuple[Shape, str]]
KNEE, ELBOW = (-3.14, 0.0, 1000.0, 0.5), (0.0, 3.14, 1000.0, 0.5)


def _rod(low: float, high: float, radius: float) -> Capsule:
    return Capsule("y", low, high, radius)


def _limbs(side: str) -> list[Link]:
    foot = box(0.708, 0.22, 0.36, (0.18, -0.09, 0))
    shoe: Looks = [(box(0.72, 0.05, 0.37, (0.18, -0.185, 0)), "graphite")]
    return [
        solid(f"{side}_hip", 4.5, [_rod(-1.44, -0.24, 0.22)], "blue", com=(0, -0.84, 0)),
        solid(f"{side}_knee", 3.0, [_rod(-1.42, -0.18, 0.20)], "blue", com=(0, -0.8, 0)),
        solid(f"{side}_ankle", 1.0, [foot], "slate", looks=shoe, com=(0.18, -0.09, 0)),
        solid(f"{side}_shoulder", 1.5, [_rod(-0.92, -0.20, 0.18)], "shell", com=(0, -0.56, 0)),
        solid(f"{side}_elbow", 1.0, [_rod(-0.75, -0.21, 0.16)], "cream", com=(0, -0.48, 0)),
        solid(f"{side}_wrist", 0.5, [Sphere(0.16)], "cream"),
    ]


def _joints(side: str, s: float) -> list[Joint]:
    z: Vec3 = (0.0, 0.0, 1.0)

    def ball(name: str, parent: str, at: Vec3) -> Joint:
        return Joint(f"{side}_{name}", "spherical", parent, f"{side}_{name}", at, ZERO, (1.0, 0.0, 0.0))

    def hinge(name: str, parent: str, at: Vec3, limits: tuple[float, float, float, float]) -> Joint:
        return Joint(f"{side}_{name}", "revolute", f"{side}_{parent}", f"{side}_{name}", at, ZERO, z, limits)

    return [
        ball("hip", "root", (0, 0, s * 0.339548)),
        hinge("knee", "hip", (0, -1.686184, 0), KNEE),
        ball("ankle", f"{side}_knee", (0, -1.63948, 0)),
        ball("shoulder", "chest", (-0.0962, 0.974, s * 0.73244)),
        hinge("elbow", "shoulder", (0, -1.099152, 0), ELBOW),
        Joint(f"{side}_wrist", "fixed", f"{side}_elbow", f"{side}_wrist", (0, -1.035788, 0)),
    ]


def files() -> Files:
    eyes: Looks = [(Sphere(0.05, (0.375, 0.78, s * 0.13)), "graphite") for s in (1, -1)]
    eyes.append((_rod(-0.1, 0.5, 0.16), "cream"))
    pelvis: Looks = [
        (Capsule("z", -0.30, 0.30, 0.24, (0, -0.05, 0)), "blue"),
        (Cylinder("y", 0.50, 0.60, 0.33), "accent"),
    ]
    ribs: Looks = [(Capsule("z", -0.50, 0.50, 0.24, (-0.06, 0.80, 0)), "shell"), (_rod(-0.42, 0.60, 0.30), "shell")]
    trunk = [
        solid("base", 0.0001, [], like=[Sphere(0.01)]),
        solid("root", 6.0, [Sphere(0.36, (0, 0.28, 0))], "blue", looks=pelvis),
        solid("chest", 14.0, [Sphere(0.44, (0, 0.48, 0))], "shell", looks=ribs),
        solid("neck", 2.0, [Sphere(0.41, (0, 0.70, 0))], "cream", looks=eyes),
    ]
    spine = [
        Joint("root", "fixed", "base", "root", ZERO),
        Joint("chest", "spherical", "root", "chest", (0, 0.944604, 0), ZERO, (1.0, 0.0, 0.0)),
        Joint("neck", "spherical", "chest", "neck", (0, 0.895576, 0), ZERO, (1.0, 0.0, 0.0)),
    ]
    limbs = [*_limbs("right"), *_limbs("left")]
    joints = [*spine, *_joints("right", 1.0), *_joints("left", -1.0)]
    return place("humanoid/humanoid.urdf", model("dumpUrdf", [*trunk, *limbs], joints))
