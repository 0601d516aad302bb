"""What MuJoCo sees while a script is at work, written beside the scene."""

import xml.etree.ElementTree as ET
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.realfiles.exports.scene import write_scene

mujoco: Any = import_module("mujoco")  # most of it has no stubs


class Recorder:
    """Steps a model, and keeps commands, mocap poses and states: those before each step, and the last."""

    def __init__(self, model: Any, data: Any) -> None:
        self.model, self.data = model, data
        self.rows: dict[str, list[Any]] = {name: [] for name in ("ctrl", "mocap_pos", "mocap_quat", "qpos", "qvel")}

    def note(self) -> None:
        """To be called when everything is set for a step, before it."""
        for name, rows in self.rows.items():
            rows.append(getattr(self.data, name).copy())

    def step(self) -> None:
        """One step of MuJoCo."""
        self.note()
        mujoco.mj_step(self.model, self.data)

    def write(self, folder: Path, files: Path) -> None:
        """`scene.xml` and `motion.npz`; `files`: the folder to which the scene's files are relative."""
        for name in ("qpos", "qvel"):
            self.rows[name].append(getattr(self.data, name).copy())
        write_scene(self.model, files, folder)
        give_inertias(folder / "scene.xml", self.model)
        arrays: dict[str, Any] = {name: np.array(rows) for name, rows in self.rows.items()}
        np.savez_compressed(folder / "motion.npz", **arrays)


def give_inertias(path: Path, model: Any) -> None:
    """Writes each body's inertia into the file: MuJoCo's text forgets which groups of geoms have mass."""
    tree = ET.parse(path)
    for compiler in tree.iter("compiler"):
        compiler.set("inertiafromgeom", "false")
    bodies = [body for world in tree.iter("worldbody") for body in world.iter("body")]
    for i, body in enumerate(bodies, start=1):
        for known in body.findall("inertial"):
            body.remove(known)
        if model.body_mass[i] > 0:
            rows = {"pos": model.body_ipos, "quat": model.body_iquat, "diaginertia": model.body_inertia}
            words = {name: " ".join(map(repr, row[i].tolist())) for name, row in rows.items()}
            ET.SubElement(body, "inertial", words | {"mass": repr(float(model.body_mass[i]))})
    tree.write(path)
