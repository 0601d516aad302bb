"""Scenes of boxes and cylinders before the arm of examples/pick_and_place.py, made from seeds."""

import math

import numpy as np

import manyhands as mh
from examples.pick_and_place import station

BIN = np.array([[-0.2, 0.37, 0.0], [0.2, 0.67, 0.206]])  # from one corner to the other [m]
_APART = 0.13  # middles of things, at least [m]


def scene(seed: int, count: int = 5) -> tuple[mh.World, list[str]]:
    """A world, and the names of the things in it: of 24 to 90 mm, 0.1 kg, each second one a cylinder."""
    rng = np.random.default_rng(seed)
    world, places, names = station(), [], [f"item{k}" for k in range(count)]
    while len(places) < count:
        place = rng.uniform([0.38, -0.25], [0.65, 0.2])
        if all(math.dist(place, other) > _APART for other in places):
            places.append(place)
    for k, (name, (x, y)) in enumerate(zip(names, places, strict=True)):
        half, yaw = rng.uniform([0.012, 0.012, 0.015], [0.03, 0.045, 0.04]), rng.uniform(0, math.pi)
        position, turn = [x, y, half[2]], [0, 0, math.sin(yaw / 2), math.cos(yaw / 2)]
        if k % 2 == 0:
            world.add_box(name, half, 0.1, position, turn, friction=0.6)
        else:
            world.add_cylinder(name, half[0], half[2], 0.1, position, friction=0.6)
    return world, names


def in_bin(world: mh.World, names: list[str]) -> list[str]:
    """Those whose centre of mass lies in the bin."""
    return [name for name in names if (np.abs(world.body_pose(name)[0] - BIN.mean(0)) < np.ptp(BIN, axis=0) / 2).all()]
