"""Recordings, made where they are not there yet, each by its package in an environment of its own."""

from pathlib import Path

from benchmarks.realfiles.composed import COMPOSERS, Composer, environment, run_module
from benchmarks.scripted.tasks import Task

RECORDERS = {
    "robosuite": next(composer for composer in COMPOSERS if composer.script == "robosuite_scenes"),
    "metaworld": Composer(
        "metaworld tasks",
        "metaworld_tasks",
        ("metaworld==3.1.1", "gymnasium==1.4.0", "gymnasium-robotics==1.4.2", "mujoco==3.3.0", "numpy==2.4.6"),
    ),
}


def record(tasks: list[Task], recordings: Path, environments: Path) -> None:
    """Makes what is missing: `recordings`/package/task with the scene and its motion.

    environments: where the packages' environments lie, or are made. Raises subprocess.CalledProcessError.
    """
    for package, composer in RECORDERS.items():
        folder = recordings.resolve() / package
        wanted = [task.name for task in tasks if task.package == package]
        missing = [name for name in wanted if not (folder / name / "motion.npz").is_file()]
        if missing:
            folder.mkdir(parents=True, exist_ok=True)
            python = environment(composer, environments.resolve())
            run_module(python, f"benchmarks.scripted.recorders.{package}_tasks", [str(folder), *missing], folder)
