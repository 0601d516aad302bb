"""Scenes that no file holds: their packages compose them, each in an environment of its own, and they are written."""

import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Composer:
    """A package that makes scenes, with what it needs, exactly pinned; its MuJoCo need not be ours.

    script: the module that writes them, by its name in `exports`.
    """

    collection: str
    script: str
    requirements: tuple[str, ...]


COMPOSERS = (
    Composer("robosuite scenes", "robosuite_scenes", ("robosuite==1.5.2", "mujoco==3.3.0", "numpy==1.26.4")),
    Composer("dm_control scenes", "dm_control_scenes", ("dm_control==1.0.50", "mujoco==3.17.0")),
)


def compose(composer: Composer, folder: Path) -> Path:
    """The folder of its scenes, made if they are not there yet; a log beside them tells what could not be made."""
    scenes = folder / composer.collection.replace(" ", "_")
    done = scenes / "done"
    if done.is_file() and done.read_text() == "\n".join(composer.requirements):
        return scenes
    python = environment(composer, folder)
    scenes.mkdir(parents=True, exist_ok=True)
    run_module(python, f"benchmarks.realfiles.exports.{composer.script}", [str(scenes)], scenes)
    done.write_text("\n".join(composer.requirements))
    return scenes


def run_module(python: Path, module: str, arguments: Sequence[str], folder: Path) -> None:
    """Runs a module of ours by another interpreter, in `folder`, where `log.txt` keeps what it prints."""
    with (folder / "log.txt").open("w") as log:
        command = [str(python), "-P", "-m", module, *arguments]
        unseen = os.environ | {"MUJOCO_GL": "disable", "PYTHONPATH": str(ROOT)}  # nothing is drawn
        subprocess.run(command, check=True, stdout=log, stderr=subprocess.STDOUT, cwd=folder, env=unseen)


def environment(composer: Composer, folder: Path) -> Path:
    """The interpreter of a virtual environment with the package in it."""
    home = folder / f"environment_{composer.script}"
    python = home / "bin" / "python"
    done = home / "done"
    if not done.is_file() or done.read_text() != "\n".join(composer.requirements):
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(home)], check=True)
        install = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*install, *composer.requirements], check=True)
        done.write_text("\n".join(composer.requirements))
    return python
