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
    mjcf_arms,
    objects,
    quadrupeds,
    r2d2,
    random_objects,
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
    mjcf_arms,
    random_objects,
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
