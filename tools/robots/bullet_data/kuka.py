"""An arm of the LBR iiwa's kinematics, alone and with a gripper of two fingers with two joints each."""

from __future__ import annotations

import math
from dataclasses import replace

from robots.bullet_data import kuka_shells
from robots.bullet_data.common import Files, box, model, obj, place, solid
from robots.bullet_data.sdf_text import world_text
from robots.description import HALF_PI, UP, ZERO, Box, Cylinder, Joint, Link, MeshFile, Parts, Robot, Shape, Vec3

ELBOW, R = 0.072, 0.066


def _half_elbow(axis: str, side: float, centre: Vec3 = ZERO) -> Cylinder:
    low, high = sorted((0.0, side * 0.082))
    return Cylinder(axis, low, high, ELBOW, centre)


BASE: list[Shape] = [Box((-0.136, -0.104, 0.0), (0.104, 0.104, 0.032)), Cylinder("z", 0.0, 0.1565, R + 0.004)]
SHAPES: list[list[Shape]] = [
    [Cylinder("z", 0.001, 0.125, R), _half_elbow("y", -1.0, (0, 0, 0.2025))],
    [_half_elbow("z", 1.0), Cylinder("y", 0.075, 0.2035, R)],
    [Cylinder("z", 0.001, 0.138, R), _half_elbow("y", 1.0, (0, 0, 0.2155))],
    [_half_elbow("z", 1.0), Cylinder("y", 0.075, 0.1835, R)],
    [
        Cylinder("z", 0.001, 0.10, R),
        Box((-0.04, 0.030, 0.10), (0.04, 0.086, 0.17)),
        Cylinder("y", 0.055, 0.096, 0.052, (0, 0, 0.2155)),
    ],
    [Cylinder("z", -0.053, 0.060, 0.056), Cylinder("y", 0.0, 0.060, 0.050)],
    [Cylinder("z", -0.018, 0.045, 0.046)],
]
MASSES = [4.0, 4.0, 3.0, 2.7, 1.7, 1.8, 0.3]
CENTRES: list[Vec3] = [
    (0, -0.03, 0.12),
    (0.0003, 0.059, 0.042),
    (0, 0.03, 0.13),
    (0, 0.067, 0.034),
    (0.0001, 0.021, 0.076),
    (0, 0.0006, 0.0004),
    (0, 0, 0.02),
]
ORIGINS: list[tuple[Vec3, Vec3]] = [
    ((0, 0, 0.1575), ZERO),
    ((0, 0, 0.2025), (HALF_PI, 0, math.pi)),
    ((0, 0.2045, 0), (HALF_PI, 0, math.pi)),
    ((0, 0, 0.2155), (HALF_PI, 0, 0)),
    ((0, 0.1845, 0), (-HALF_PI, math.pi, 0)),
    ((0, 0, 0.2155), (HALF_PI, 0, 0)),
    ((0, 0.081, 0), (-HALF_PI, math.pi, 0)),
]
WIDE, NARROW, LAST = (-2.96705972839, 2.96705972839), (-2.09439510239, 2.09439510239), (-3.05432619099, 3.05432619099)
LIMITS = [WIDE, NARROW, WIDE, NARROW, WIDE, NARROW, LAST]
SHELLS: dict[str, Parts] = {}


def _shells() -> dict[str, Parts]:
    """Made once: several files show them."""
    if not SHELLS:
        SHELLS.update(
            link0=kuka_shells.base(),
            link1=kuka_shells.riser(0.2025, -1.0),
            link2=kuka_shells.crank(0.2045, 1.0),
            link3=kuka_shells.riser(0.2155, 1.0),
            link4=kuka_shells.crank(0.1845, 1.0),
            link5=kuka_shells.forearm(),
            link6=kuka_shells.wrist(),
            link7=kuka_shells.flange(),
        )
    return SHELLS


def _meshes(link: str) -> list[tuple[Shape, str]]:
    return [(MeshFile(f"visual/{link}_{material}.obj"), material) for material in _shells()[link]]


def _arm(
    base_mass: float, names: list[str], limits: list[tuple[float, float]], hand: float = 0.3
) -> tuple[list[Link], list[Joint]]:
    base = solid("lbr_iiwa_link_0", base_mass, BASE, looks=_meshes("link0"), com=(-0.1, 0, 0.07))
    links, joints = [base], []
    for k in range(7):
        mass = hand if k == 6 else MASSES[k]
        name = f"lbr_iiwa_link_{k + 1}"
        links.append(solid(name, mass, SHAPES[k], looks=_meshes(f"link{k + 1}"), com=CENTRES[k]))
        xyz, rpy = ORIGINS[k]
        range_ = (*limits[k], 300.0, 10.0)
        joint = Joint(names[k], "revolute", f"lbr_iiwa_link_{k}", name, xyz, rpy, UP, range_, damping=0.5)
        joints.append(joint)
    return links, joints


def _urdf(base_mass: float, limits: list[tuple[float, float]]) -> Robot:
    names = [f"lbr_iiwa_joint_{k + 1}" for k in range(7)]
    return model("lbr_iiwa", *_arm(base_mass, names, limits))


def _finger(side: str, s: float, bar_mass: float) -> tuple[list[Link], list[Joint]]:
    """A finger of three links: a bar that the gripper turns, its outer half, and a tip. Mirrored in x by `s`."""

    def across(low: Vec3, high: Vec3) -> Box:
        a, b = sorted((s * low[0], s * high[0]))
        return Box((a, low[1], low[2]), (b, high[1], high[2]))

    soft = {"lateral_friction": 0.8, "spinning_friction": 0.1}
    bar = solid(
        f"{side}_finger", bar_mass, [box(0.01, 0.01, 0.08, (0, 0, 0.04))], "metal", contact=soft if s < 0 else {}
    )
    outer: list[Shape] = [across((-0.012, -0.012, -0.004), (0.004, 0.012, 0.064))]
    middle = solid(f"{side}_finger_base", 0.2, outer, "graphite", com=(-0.003 * s, 0, 0.04), contact=soft)
    blade: list[Shape] = [across((-0.007, -0.010, -0.003), (0.007, 0.010, 0.052))]
    pad: list[tuple[Shape, str]] = [(across((0.0055, -0.0085, 0.012), (0.0078, 0.0085, 0.050)), "accent")]
    tip = solid(f"{side}_finger_tip", 0.2, blade, "slate", looks=pad, com=(-0.005 * s, 0, 0.026), contact=soft)
    first = (-10.4, 10.01) if s > 0 else (-10.01, 10.4)
    last = (-10.1, 10.3) if s > 0 else (-10.3, 10.1)
    y = (0.0, 1.0, 0.0)
    joints = [
        Joint(
            f"base_{side}_finger_joint",
            "revolute",
            "base_link",
            bar.name,
            (0, 0.024, 0.045),
            (0, -0.05 * s, 0),
            y,
            (*first, 100.0, 0.0),
        ),
        Joint(
            f"{side}_finger_base_joint",
            "fixed",
            bar.name,
            middle.name,
            (-0.000995418 * s, 0, 0.0801499),
            (0, -0.25 * s, 0),
        ),
        Joint(
            f"{side}_base_tip_joint",
            "revolute",
            middle.name,
            tip.name,
            (0.00340117 * s, 0, 0.061753),
            (0, 0.5 * s, 0),
            y,
            (*last, 0.0, 0.0),
        ),
    ]
    return [bar, middle, tip], joints


def _with_gripper(turns: bool) -> Robot:
    """The arm and its gripper; `turns`: the gripper hangs on a joint about z."""
    links, joints = _arm(0.0, [f"J{k}" for k in range(7)], LIMITS, hand=1.3 if turns else 0.3)
    mass = 0.2 if turns else 1.2
    hand = solid(
        "base_link", mass, [box(0.05, 0.05, 0.1)], "graphite", looks=[(box(0.03, 0.078, 0.034, (0, 0, 0.030)), "shell")]
    )
    mount = Joint(
        "gripper_to_arm", "continuous" if turns else "fixed", "lbr_iiwa_link_7", "base_link", (0, 0, 0.044), ZERO, UP
    )
    links.append(hand)
    joints.append(mount)
    for side, s in (("left", 1.0), ("right", -1.0)):
        more_links, more_joints = _finger(side, s, 0.2 if turns else 0.1)
        links += more_links
        joints += more_joints
    return model("lbr_iiwa_with_wsg50", links, joints)


def files() -> Files:
    vr = [(-0.96705972839, 0.96705972839), *LIMITS[1:3], (0.19439510239, 2.29439510239), *LIMITS[4:]]
    arm = _urdf(0.0, LIMITS)
    meshes = {
        f"kuka_iiwa/visual/{link}_{material}.obj": obj(mesh)
        for link, parts in _shells().items()
        for material, mesh in parts.items()
    }
    return {
        **meshes,
        **place("kuka_iiwa/model.urdf", arm),
        **place("kuka_iiwa/model_vr_limits.urdf", _urdf(0.0, vr)),
        **place("kuka_iiwa/model_free_base.urdf", _urdf(0.1, LIMITS)),
        "kuka_iiwa/model.sdf": world_text([arm], at=(0.0, -2.3, 0.7)),
        "kuka_iiwa/kuka_world.sdf": world_text([replace(arm, name="lbr_iiwa")]),
        "kuka_iiwa/kuka_with_gripper.sdf": world_text([_with_gripper(turns=False)]),
        "kuka_iiwa/kuka_with_gripper2.sdf": world_text([_with_gripper(turns=True)]),
    }
