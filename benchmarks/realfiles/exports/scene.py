"""A composed scene as MJCF with its files."""

import shutil
import tempfile
import xml.etree.ElementTree as ET
from importlib import import_module
from pathlib import Path
from typing import Any

mujoco: Any = import_module("mujoco")  # most of it has no stubs


def write_scene(model: Any, files: Path, folder: Path) -> None:
    """Writes `folder`, with the text, and its files beside it, numbered.

    model: the last that was loaded, with its present numbers; files: the folder to which its files are relative.
    """
    with tempfile.TemporaryDirectory() as aside:
        text = Path(aside) / "scene.xml"
        mujoco.mj_saveLastXML(str(text), model)
        root = ET.parse(text).getroot()
    partial = folder.with_name(f"{folder.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for element in root.iter():
        source = element.get("file")
        if source is not None:
            own = f"{len(list(partial.iterdir()))}_{Path(source).name}"
            shutil.copy(files / source, partial / own)
            element.set("file", own)
    for compiler in root.iter("compiler"):
        for folders in ("meshdir", "texturedir", "assetdir"):
            compiler.attrib.pop(folders, None)
    ET.ElementTree(root).write(partial / "scene.xml")
    shutil.rmtree(folder, ignore_errors=True)
    partial.rename(folder)
