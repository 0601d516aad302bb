"""Where the models lie that programs load by their usual names: "plane.urdf", "kuka_iiwa/model.urdf"."""

import sys
from pathlib import Path

from manyhands._core import asset_path

__all__ = ["getDataPath"]


def getDataPath() -> str:  # noqa: N802  the name it has in pybullet_data
    """The folder of the installed package pybullet_data, if there is one, else that of this package's own models.

    Raises FileNotFoundError if neither is there.
    """
    for entry in sys.path:
        folder = Path(entry) / "pybullet_data"
        if (folder / "plane.urdf").is_file():
            return str(folder.resolve())
    return str(asset_path("bullet"))
