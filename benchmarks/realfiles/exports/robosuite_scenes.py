"""Writes the scenes of robosuite's environments, and the meshes they use, below the folder that is its argument."""

import shutil
import sys
import traceback
import xml.etree.ElementTree as ET
from pathlib import Path

import robosuite  # pyright: ignore[reportMissingImports]

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
    root = ET.fromstring(environment.sim.model.get_xml())
    partial = folder / f"{name}.partial"
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for element in root.iter():
        source = element.get("file")
        if source is not None:
            own = f"{len(list(partial.iterdir()))}_{Path(source).name}"
            shutil.copy(source, partial / own)
            element.set("file", own)
    for compiler in root.iter("compiler"):
        for folders in ("meshdir", "texturedir", "assetdir"):
            compiler.attrib.pop(folders, None)
    ET.ElementTree(root).write(partial / "scene.xml")
    partial.rename(folder / name)


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
