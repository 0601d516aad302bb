"""One file, examined stage by stage in a process of its own; what a stage finds is told at once."""

import resource
import tempfile
from dataclasses import dataclass
from os import chdir

from benchmarks.children import Say
from benchmarks.realfiles import accelerations, motion, statics
from benchmarks.realfiles.files import File
from benchmarks.realfiles.loading import features, load_ours, load_theirs, overlap, scene_of, serious

MEMORY = 12 << 30  # [bytes] of addresses


@dataclass(frozen=True)
class Task:
    """A file and how long its motions last."""

    file: File
    seconds: float  # simulated; 0 leaves motion out
    budget: float  # of the processor, for each motion [s]
    limit: float  # of the processor, for all [s]


def examine(say: Say, task: Task) -> None:
    """Tells {"stage": name, ...} before each stage, and its findings after it."""
    limit = int(task.limit)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as scratch:
        chdir(scratch)  # MuJoCo writes its warnings to a file there
        examine_here(say, task)


def examine_here(say: Say, task: Task) -> None:
    """The stages."""
    say({"stage": "MuJoCo"})
    model, why = load_theirs(task.file.path)
    say({"mujoco": why})
    say({"stage": "load"})
    ours = load_ours(task.file.path)
    say({"load": {"refused": ours.refused, "warned": ours.warned, "loaded": ours.model is not None}})
    if model is None or ours.report is None:
        return
    scene = scene_of(model, ours)
    if scene is None:
        return
    say({"serious": serious(ours.report), "features": features(model), "overlap": overlap(model), "nv": model.nv})
    say({"stage": "statics"})
    found = statics.compare(scene)
    say({"statics": found})
    if any(found.get(kind) for kind in ("dofs", "names")) or not model.nv:
        return
    say({"stage": "accelerations"})
    say({"accelerations": accelerations.compare(scene)})
    if task.seconds > 0:
        say({"stage": "motion"})
        motion.compare(scene, task.seconds, task.budget, lambda run: say({"run": run}))
