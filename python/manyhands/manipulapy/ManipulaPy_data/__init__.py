"""Robots by the names of ManipulaPy: this project's own descriptions, with shapes and inertias of its own. Where
ManipulaPy has a robot and this project has not, the name is unknown here."""

import re
from pathlib import Path
from typing import Any

from manyhands._core import asset_path

_XARM = {"manufacturer": "UFACTORY", "dof": 6, "file": "bullet/xarm/xarm6_robot.urdf"}
_UR5E = {"manufacturer": "Universal Robots", "dof": 6, "file": "bullet/universal/ur5e.urdf"}
_PANDA = {"manufacturer": "Franka", "dof": 7, "file": "panda/panda.urdf"}
_IIWA = {"manufacturer": "KUKA", "dof": 7, "file": "bullet/kuka_iiwa/model.urdf"}
_ARM6 = {"manufacturer": "manyhands", "dof": 6, "file": "arm6/arm6.urdf"}

ROBOT_DATABASE: dict[str, dict[str, Any]] = {
    "arm6": {"description": "an arm of six axes with a gripper", **_ARM6},
    "iiwa14": {"description": "an arm of seven axes, of the LBR iiwa's kind", **_IIWA},
    "panda": {"description": "an arm of seven axes with a gripper, of the Panda's kind", **_PANDA},
    "ur5": {"description": "an arm of six axes, of the UR5e's kind", **_UR5E},
    "ur5e": {"description": "an arm of six axes, of the UR5e's kind", **_UR5E},
    "xarm6": {"description": "an arm of six axes, of the xArm6's kind", **_XARM},
}

_ALIASES = {"franka_panda": "panda", "kuka_iiwa": "iiwa14", "iiwa7": "iiwa14", "xarm": "xarm6"}


def _known(name: str) -> str:
    key = re.sub(r"[\s-]+", "_", name.strip().lower())
    key = _ALIASES.get(key, key)
    if key not in ROBOT_DATABASE:
        raise ValueError(f"there is no robot {name!r}; there are {', '.join(ROBOT_DATABASE)}")
    return key


def get_robot_urdf(robot_name: str) -> str:
    """The path of a robot's file. Raises ValueError on an unknown name."""
    return str(asset_path(ROBOT_DATABASE[_known(robot_name)]["file"]))


def get_robot_info(robot_name: str) -> dict[str, Any]:
    """What is known of a robot."""
    return dict(ROBOT_DATABASE[_known(robot_name)])


def get_robot_path(robot_name: str, model: str | None = None) -> str:
    """The folder of a robot's file."""
    return str(Path(get_robot_urdf(model or robot_name)).parent)


def list_robots(manufacturer: str | None = None) -> list[str]:
    """All names, or those of a manufacturer."""
    wanted = None if manufacturer is None else manufacturer.lower()
    return sorted(
        name for name, info in ROBOT_DATABASE.items() if wanted is None or wanted in info["manufacturer"].lower()
    )


list_available_robots = get_all_available_robots = list_robots


def list_manufacturers() -> list[str]:
    return sorted({info["manufacturer"] for info in ROBOT_DATABASE.values()})


def get_robots_by_dof(dof: int) -> list[str]:
    """The robots with so many joints, fingers not counted."""
    return sorted(name for name, info in ROBOT_DATABASE.items() if info["dof"] == dof)


def check_robot_available(robot_name: str) -> bool:
    try:
        return Path(get_robot_urdf(robot_name)).is_file()
    except ValueError:
        return False


def print_robot_catalog() -> None:
    for name, info in ROBOT_DATABASE.items():
        print(f"{name:10} {info['dof']} joints  {info['manufacturer']:18} {info['description']}")


def get_ur5_urdf() -> str:
    return get_robot_urdf("ur5")


def get_xarm_urdf(model: str = "xarm6") -> str:
    return get_robot_urdf(model)


def get_panda_urdf() -> str:
    return get_robot_urdf("panda")


def get_iiwa_urdf(variant: str = "iiwa14") -> str:
    return get_robot_urdf(variant)
