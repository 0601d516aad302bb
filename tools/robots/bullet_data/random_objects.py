"""Fifty small things of one to three parts to sort and to grasp, where PyBullet has a thousand."""

from __future__ import annotations

from random import Random

from robots.bullet_data.common import Files, box, model, place, solid
from robots.description import Capsule, Cylinder, Shape, Sphere, Vec3

COUNT = 50
LOOKS = ("accent", "teal", "blue", "yellow", "green", "red", "sky", "oak")
CONTACT = {"lateral_friction": 1.0, "rolling_friction": 0.0, "inertia_scaling": 3.0}


def _part(dice: Random, at: Vec3) -> Shape:
    """A box, rod or ball about `at`, 2 to 7 cm long."""

    def length(low: float, high: float) -> float:
        return round(low + (high - low) * dice.random(), 3)

    kind = int(4 * dice.random())
    if kind == 0:
        return Sphere(length(0.014, 0.022), at)
    if kind == 1:
        return box(length(0.02, 0.035), length(0.02, 0.035), length(0.03, 0.06), at)
    axis = int(3 * dice.random())
    half, radius = length(0.014, 0.03), length(0.009, 0.016)
    low, high = round(at[axis] - half, 3), round(at[axis] + half, 3)
    return (Capsule if kind == 2 else Cylinder)("xyz"[axis], low, high, radius, at)


def files() -> Files:
    made: Files = {}
    for k in range(COUNT):
        dice = Random(k)
        shapes: list[Shape] = [_part(dice, (0.0, 0.0, 0.0))]
        for _ in range(int(3 * dice.random())):
            at = tuple(round(0.04 * dice.random() - 0.02, 3) for _ in range(3))
            shapes.append(_part(dice, (at[0], at[1], at[2])))
        look = LOOKS[k % len(LOOKS)]
        link = solid(f"random_obj_{k:03d}", 0.1, shapes, look, com=(0.0, 0.0, 0.0), contact=CONTACT)
        made |= place(f"random_urdfs/{k:03d}/{k:03d}.urdf", model(f"blob{k:03d}", [link]))
    return made
