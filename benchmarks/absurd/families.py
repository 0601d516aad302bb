"""All families, and how a number becomes a scene."""

from collections.abc import Callable

from benchmarks.absurd import bodies, mechanisms
from benchmarks.absurd.draw import Draw
from benchmarks.absurd.setting import Setting

Family = Callable[[Setting], None]


def mixture(setting: Setting) -> None:
    """Two or three families in one place, at any time step, speed and weight."""
    for index in sorted(setting.draw.rng.permutation(len(SINGLE))[: setting.draw.count(2, 3)]):
        list(SINGLE.values())[index](setting)
    distort(setting, 0.4)


SINGLE: dict[str, Family] = {
    "overlap": bodies.overlap,
    "walls": bodies.walls,
    "loops": mechanisms.loops,
    "mass ratios": bodies.ratios,
    "heavy arms": mechanisms.heavy_arms,
    "inertias": bodies.inertias,
    "sizes": bodies.sizes,
    "speeds": bodies.speeds,
    "gains": mechanisms.gains,
    "limits": mechanisms.limits,
    "tendons": mechanisms.tendons,
    "mocap": mechanisms.mocap,
    "surfaces": bodies.surfaces,
    "ground": bodies.ground,
}
FAMILIES: dict[str, Family] = SINGLE | {"mixture": mixture}


def distort(setting: Setting, harsh: float) -> None:
    """Now and then another time step, gravity, or speed."""
    draw = setting.draw
    if draw.chance(harsh):
        setting.time_step = draw.log(1e-6, 0.1)
    if draw.chance(harsh):
        setting.gravity = draw.pick((0.0, draw.log(1e-3, 1e4), 1e4)) * draw.direction()
    if draw.chance(harsh):
        most = draw.log(1e-2, 1e6)
        setting.speeds = {name: most * draw.rng.normal(size=len(v)) for name, v in setting.speeds.items()}


def family_of(number: int) -> str:
    """Families take turns."""
    return list(FAMILIES)[number % len(FAMILIES)]


def setting_of(seed: int, number: int) -> Setting:
    """The scene of that number."""
    setting = Setting(Draw(seed, number))
    FAMILIES[family_of(number)](setting)
    distort(setting, 0.1)
    return setting
