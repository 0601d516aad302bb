"""Arms: our Panda under the name of PyBullet's, our six-axis arm with the usual names of a UR5e, and an xArm 6."""

from __future__ import annotations

import math
from dataclasses import replace

from robots.arm6 import ARM6
from robots.bullet_data.common import SCRIPT, Files, model, place, solid
from robots.description import HALF_PI, UP, ZERO, Capsule, Cylinder, Joint, Link, Placed, Robot, Shape, Sphere, Vec3
from robots.panda import PANDA


def _panda() -> Files:
    """It shares the meshes of assets/panda."""
    robot = replace(PANDA, script=SCRIPT, meshes="../../panda/")
    return place("franka_panda/panda.urdf", robot)


UR_LINKS = {
    "arm6_link0": "base_link",
    "arm6_link1": "shoulder_link",
    "arm6_link2": "upper_arm_link",
    "arm6_link3": "forearm_link",
    "arm6_link4": "wrist_1_link",
    "arm6_link5": "wrist_2_link",
    "arm6_link6": "wrist_3_link",
}
UR_JOINTS = {
    "arm6_joint1": "shoulder_pan_joint",
    "arm6_joint2": "shoulder_lift_joint",
    "arm6_joint3": "elbow_joint",
    "arm6_joint4": "wrist_1_joint",
    "arm6_joint5": "wrist_2_joint",
    "arm6_joint6": "wrist_3_joint",
}


def _universal() -> Files:
    """Six joints between `world` and `tool0`; it shares the meshes of assets/arm6, without the hand."""
    links = [replace(link, name=UR_LINKS[link.name]) for link in ARM6.links if link.name in UR_LINKS]
    joints = [
        replace(j, name=UR_JOINTS[j.name], parent=UR_LINKS[j.parent], child=UR_LINKS[j.child])
        for j in ARM6.joints
        if j.name in UR_JOINTS
    ]
    ends = [Joint("world_joint", "fixed", "world", "base_link", ZERO)]
    tool = Joint("wrist_3-tool0", "fixed", "wrist_3_link", "tool0", ZERO)
    shells = {key: make for key, make in ARM6.shells.items() if key in {link.visual for link in links}}
    robot = Robot(
        "ur5e", SCRIPT, ARM6.materials, [Link("world"), *links, Link("tool0")], [*ends, *joints, tool], shells
    )
    return place("universal/ur5e.urdf", replace(robot, meshes="../../arm6/"))


# The xArm 6: what stands between two joints, in the link's frame.
XARM: list[tuple[str, float, Vec3, list[Shape], list[tuple[Shape, str]]]] = [
    (
        "link_base",
        2.7,
        (0, 0, 0.09103),
        [Cylinder("z", 0.0, 0.03, 0.065), Cylinder("z", 0.03, 0.19, 0.052)],
        [(Cylinder("z", 0.19, 0.196, 0.049), "accent")],
    ),
    (
        "link1",
        2.16,
        (-0.002, 0.02692, -0.01332),
        [Cylinder("z", -0.071, -0.02, 0.052), Capsule("y", -0.022, 0.030, 0.052)],
        [(Cylinder("y", 0.070, 0.084, 0.036), "graphite"), (Cylinder("y", -0.078, -0.072, 0.036), "graphite")],
    ),
    (
        "link2",
        1.71,
        (0.03531, -0.21398, 0.03386),
        [
            Cylinder("z", -0.046, 0.118, 0.052),
            Placed(Capsule("z", -0.142, 0.142, 0.036), (0.027, -0.142, 0.088), (HALF_PI, 0, 0.186)),
            Cylinder("z", 0.030, 0.118, 0.050, (0.0535, -0.2845, 0)),
        ],
        [
            (Cylinder("z", 0.118, 0.123, 0.036), "graphite"),
            (Cylinder("z", 0.118, 0.123, 0.034, (0.0535, -0.2845, 0)), "graphite"),
        ],
    ),
    (
        "link3",
        1.384,
        (0.06781, 0.10749, 0.01457),
        [
            Cylinder("z", -0.050, 0.028, 0.046),
            Capsule("x", 0.0, 0.0775, 0.036, (0, 0, -0.008)),
            Sphere(0.044, (0.0775, 0.035, 0)),
            Cylinder("y", 0.04, 0.20, 0.044, (0.0775, 0, 0)),
        ],
        [
            (Cylinder("z", -0.056, -0.050, 0.032), "graphite"),
            (Cylinder("y", 0.20, 0.206, 0.041, (0.0775, 0, 0)), "accent"),
        ],
    ),
    (
        "link4",
        1.115,
        (-0.00021, 0.02578, -0.02538),
        [Cylinder("z", -0.136, -0.03, 0.044), Capsule("y", -0.018, 0.028, 0.044)],
        [(Cylinder("y", 0.062, 0.076, 0.030), "graphite")],
    ),
    (
        "link5",
        1.275,
        (0.05428, 0.01781, 0.00543),
        [
            Cylinder("z", -0.038, 0.040, 0.040),
            Capsule("x", 0.0, 0.076, 0.034),
            Cylinder("y", -0.010, 0.074, 0.040, (0.076, 0, 0)),
        ],
        [
            (Cylinder("z", 0.040, 0.046, 0.028), "graphite"),
            (Cylinder("y", 0.074, 0.079, 0.037, (0.076, 0, 0)), "accent"),
        ],
    ),
    (
        "link6",
        0.1096,
        (0, 0.00064, -0.00952),
        [Cylinder("z", -0.018, 0.0, 0.037)],
        [(Cylinder("z", -0.004, 0.0005, 0.026), "metal")],
    ),
]
XARM_JOINTS: list[tuple[Vec3, Vec3, tuple[float, float, float]]] = [
    ((0, 0, 0.267), ZERO, (-2 * math.pi, 2 * math.pi, 50.0)),
    (ZERO, (-HALF_PI, 0, 0), (-2.059, 2.0944, 50.0)),
    ((0.0535, -0.2845, 0), ZERO, (-3.927, 0.19198, 32.0)),
    ((0.0775, 0.3425, 0), (-HALF_PI, 0, 0), (-2 * math.pi, 2 * math.pi, 32.0)),
    (ZERO, (HALF_PI, 0, 0), (-1.69297, math.pi, 32.0)),
    ((0.076, 0.097, 0), (-HALF_PI, 0, 0), (-2 * math.pi, 2 * math.pi, 20.0)),
]


def _xarm() -> Files:
    links = [Link("world")]
    links += [solid(name, mass, shapes, "shell", looks=looks, com=com) for name, mass, com, shapes, looks in XARM]
    joints = [Joint("world_joint", "fixed", "world", "link_base", ZERO)]
    for k, (xyz, rpy, (low, high, effort)) in enumerate(XARM_JOINTS, 1):
        parent = "link_base" if k == 1 else f"link{k - 1}"
        limits = (low, high, effort, 3.14)
        joints.append(
            Joint(f"joint{k}", "revolute", parent, f"link{k}", xyz, rpy, UP, limits, damping=1.0, friction=1.0)
        )
    return place("xarm/xarm6_robot.urdf", model("xarm6", links, joints))


def files() -> Files:
    return {**_panda(), **_universal(), **_xarm()}
