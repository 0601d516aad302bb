"""What differs from episode to episode, in one world: domain randomisation."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from manyhands._core import World
from manyhands.envs.spaces import as_range

Range = float | tuple[float, float] | tuple[float, float, str]
"""(low, high), uniform; (low, high, "log"), whose logarithm is uniform; or one number."""


class _Kind(NamedTuple):
    usual: float
    """Where nothing is asked for."""
    lowest: float
    highest: float
    whole: bool = False


RANGES: dict[str, _Kind] = {
    "mass": _Kind(1, 1e-3, 1e3),  # factor, of everything that moves; inertia in proportion
    "friction": _Kind(1, 0, 1e3),  # factor, of every surface
    "joint_damping": _Kind(0, 0, 1e3),  # added to every joint [N m s/rad or N s/m]
    "motor_force": _Kind(1, 0, 1e3),  # factor, of the largest force of motors and rotors
    "camera": _Kind(0, -math.pi, math.pi),  # by which the camera turns about what it looks at [rad]
    "light": _Kind(1, 0, 1.3),  # factor, of the sun's brightness
    "observation_noise": _Kind(0, 0, 1e3),  # standard deviation, fresh in each number of each observation
    "target": _Kind(1, 0, 1),  # share of their range, about its middle, in which targets are drawn
    "action_latency": _Kind(0, 0, 64, whole=True),  # steps until an action acts; until then zeros do
}
"""The nine kinds, and what they may be."""

NOTHING_VARIED: dict[str, float] = {name: kind.usual for name, kind in RANGES.items()}


class Variation:
    """Draws what an episode has."""

    def __init__(self, ranges: Mapping[str, Range]) -> None:
        """Raises ValueError on a name that there is not, or a range that is empty or beyond what is allowed."""
        if unknown := set(ranges) - set(RANGES):
            raise ValueError(f"randomize has {sorted(unknown)}; there are {', '.join(RANGES)}")
        self._ranges = {name: _checked(name, given) for name, given in ranges.items()}
        self.names = list(ranges)

    def draw(self, rng: np.random.Generator) -> dict[str, float]:
        """All nine kinds. A value depends on the generator and its own range, not on what else is asked for."""
        shares = dict(zip(RANGES, rng.random(len(RANGES)).tolist(), strict=True))
        drawn = dict(NOTHING_VARIED)
        for name, (low, high, is_log) in self._ranges.items():
            share = shares[name]
            if RANGES[name].whole:
                drawn[name] = float(min(low + math.floor(share * (high - low + 1)), high))
            else:
                drawn[name] = low * (high / low) ** share if is_log else low + share * (high - low)
        return drawn


def vary_world(world: World, varied: Mapping[str, float]) -> None:
    """Multiplies masses and frictions, and adds to dampings. A link's geoms get one coefficient of friction."""
    model = world.model
    if varied["mass"] != 1:
        for link in model.links:
            if link.body > 0 and link.mass > 0:
                world.set_mass(link.name, varied["mass"] * world.mass(link.name))
    if varied["friction"] != 1:
        for index in {geom.link for geom in model.geoms if not geom.is_visual}:
            name = model.links[index].name
            world.set_friction(name, varied["friction"] * world.friction(name))
    if varied["joint_damping"]:
        for joint in model.joints:
            if joint.nv == 1:
                world.set_damping(joint.name, world.damping(joint.name) + varied["joint_damping"])


def _checked(name: str, given: Range) -> tuple[float, float, bool]:
    kind = RANGES[name]
    _, low, high, is_log = as_range(name, given)
    if not kind.lowest <= low <= high <= kind.highest:
        raise ValueError(
            f"randomize: {name} is {given!r}, expected low <= high within [{kind.lowest:g}, {kind.highest:g}]"
        )
    if is_log and low <= 0:
        raise ValueError(f"randomize: {name} is {given!r}; the logarithm of its lower end is not finite")
    if kind.whole and (low != round(low) or high != round(high)):
        raise ValueError(f"randomize: {name} is {given!r}, expected whole numbers")
    return low, high, is_log
