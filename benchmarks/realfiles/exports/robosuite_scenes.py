"""Writes the scenes of robosuite's environments, and the meshes they use, below the folder that is its argument."""

import sys
import traceback
from pathlib import Path

import robosuite  # pyright: ignore[reportMissingImports]

from benchmarks.realfiles.exports.scene import write_scene

ONE_ARM = ("Lift", "Stack", "Door", "NutAssembly", "PickPlace", "ToolHanging", "Wipe")
TWO_ARMS = ("TwoArmLift", "TwoArmPegInHole", "TwoArmHandover", "TwoArmTransport")
ARMS = ("Panda", "Sawyer", "IIWA", "Jaco", "Kinova3", "UR5e", "XArm7")
BODIES = ("Baxter", "Tiago", "GR1", "SpotWithArm", "PandaOmron")
SCENES = (
    *((task, "Panda") for task in ONE_ARM),
    *(("Lift", robot) for robot in (*ARMS[1:], *BODIES)),
    *((task, "Sawyer") for task in ("Door", "NutAssembly", "PickPlace")),
    *((task, ["Panda", "Panda"]) for task in TWO_ARMS),
)


def export(folder: Path, task: str, robots: str | list[str]) -> None:
    """One scene: its text, and its files beside it, numbered."""
    name = "_".join([task, *([robots] if isinstance(robots, str) else robots)])
    if (folder / name).is_dir():
        return
    environment = robosuite.make(
        task, robots=robots, has_renderer=False, has_offscreen_renderer=False, use_camera_obs=False
    )
    environment.reset()
    write_scene(environment.sim.model._model, Path(), folder / name)


def main() -> None:
    """All that this version can make."""
    for task, robots in SCENES:
        try_to_export(Path(sys.argv[1]), task, robots)


def try_to_export(folder: Path, task: str, robots: str | list[str]) -> None:
    """Says so if this version cannot make it."""
    try:
        export(folder, task, robots)
    except Exception:
        print(f"robosuite makes no {task} of {robots}:")
        traceback.print_exc()


if __name__ == "__main__":
    main()
