"""All families: their files, and the catalogue."""

from __future__ import annotations

import json

from robots.bullet_data.common import Files
from robots.collection import arms, furniture, grippers, machines
from robots.collection.common import Entry
from robots.write import robot_files


def all_entries() -> list[Entry]:
    return [entry for family in (arms, machines, grippers, furniture) for entry in family.entries()]


def collection_files() -> Files:
    """Every file by its path in the folder."""
    entries = all_entries()
    files = {f"{entry.robot.name}.urdf": robot_files(entry.robot)[0].encode() for entry in entries}
    catalogue = {entry.robot.name: entry.catalogue() for entry in entries}
    return files | {"catalogue.json": (json.dumps(catalogue, indent=1) + "\n").encode()}
