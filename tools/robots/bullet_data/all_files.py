"""All families."""

from __future__ import annotations

from robots.bullet_data import (
    arms,
    gripper,
    humanoid,
    images,
    kuka,
    mechanisms,
    minitaur,
    mjcf,
    objects,
    quadrupeds,
    r2d2,
    scenery,
    wheeled,
)
from robots.bullet_data.common import Files

FAMILIES = [
    images,
    scenery,
    objects,
    r2d2,
    kuka,
    arms,
    gripper,
    wheeled,
    mechanisms,
    quadrupeds,
    minitaur,
    humanoid,
    mjcf,
]


def bullet_files() -> Files:
    """Every file by its path in the folder."""
    files: Files = {}
    for family in FAMILIES:
        made = family.files()
        twice = files.keys() & made.keys()
        if twice:
            raise ValueError(f"{family.__name__} makes {sorted(twice)} again")
        files |= made
    return files
