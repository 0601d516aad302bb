"""A task in both programs, and what its outcome is in each."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import Array, Scene
from benchmarks.scripted.recording import Recording
from benchmarks.scripted.replay import Ours, Servo, Theirs, replay
from benchmarks.scripted.scenes import harden, led_scene, scene_of
from benchmarks.scripted.tasks import Task, outcomes

SAME = 0.1  # of the recorded outcome
SUBSTEPS = 8  # of MuJoCo's where it is made hard
RECORDED, THEIRS, OURS, LED_THEIRS, LED_OURS, HARD = "recorded", "theirs", "ours", "led theirs", "led ours", "hard"
SOFT, LED_SOFT = "soft", "led soft"
RUNS = {
    RECORDED: "as it was recorded",
    THEIRS: "MuJoCo, the recorded commands",
    OURS: "manyhands, the recorded commands",
    LED_THEIRS: "MuJoCo, led along the recorded path",
    LED_OURS: "manyhands, led along the recorded path",
    HARD: "MuJoCo, led, with hard limits and contacts",
    SOFT: "manyhands, the recorded commands, all giving way as in MuJoCo",
    LED_SOFT: "manyhands, led, all giving way as in MuJoCo",
}


@dataclass
class Compared:
    """What happened. `paths`: qpos (n + 1, nq) of each run that came to its end; `failed`: why others did not."""

    task: Task
    scene: Scene
    led: Scene
    time_step: float
    paths: dict[str, Array]
    failed: dict[str, str]

    def curve(self, run: str) -> Array:
        """By how much the outcome has changed since the start, before the first and after every step."""
        return outcomes(self.task, self.scene.mujoco, self.paths[run])

    def outcome(self, run: str) -> float | None:
        """At the end, None if it did not come there."""
        return float(self.curve(run)[-1]) if run in self.paths else None

    def difference(self, beside: str) -> float:
        """Of ours, led, from another run, as a part of the recorded outcome."""
        ours, theirs, recorded = (self.outcome(run) for run in (LED_OURS, beside, RECORDED))
        return float("nan") if ours is None or theirs is None or not recorded else (ours - theirs) / abs(recorded)

    @property
    def verdict(self) -> str:
        """In a word or two."""
        if abs(self.difference(RECORDED)) <= SAME:
            return "same"
        return "as MuJoCo's when hard" if abs(self.difference(HARD)) <= SAME else "differs"

    def figures(self) -> dict[str, object]:
        """For JSON."""
        return {
            "task": self.task.title,
            "outcome": self.task.outcome,
            "unit": self.task.unit,
            "verdict": self.verdict,
            "difference": self.difference(RECORDED),
            "difference_from_hard": self.difference(HARD),
            "outcomes": {run: self.outcome(run) for run in self.paths},
            "failed": self.failed,
        }


def compare(task: Task, folder: Path) -> Compared:
    """Runs all of RUNS from `scene.xml` and `motion.npz` in the folder."""
    recording = Recording.read(folder / "motion.npz")
    scene, led, hard = scene_of(folder / "scene.xml"), led_scene(folder / "scene.xml"), led_scene(folder / "scene.xml")
    time_step = scene.mujoco.opt.timestep
    soft, led_soft = scene_of(folder / "scene.xml", "all"), led_scene(folder / "scene.xml", "all")
    harden(hard, SUBSTEPS)
    servo = Servo(scene, recording)
    start = recording.qpos[0], recording.qvel[0]
    found = Compared(task, scene, led, time_step, {RECORDED: recording.qpos}, {})
    for run, program, lead in (
        (THEIRS, Theirs(scene, *start), None),
        (OURS, Ours(scene, *start), None),
        (LED_THEIRS, Theirs(led, *start), servo),
        (LED_OURS, Ours(led, *start), servo),
        (HARD, Theirs(hard, *start, SUBSTEPS), servo),
        (SOFT, Ours(soft, *start), None),
        (LED_SOFT, Ours(led_soft, *start), servo),
    ):
        try:
            path = replay(recording, program, lead)
        except mh.SimulationError as why:
            found.failed[run] = str(why)
            continue
        if np.all(np.isfinite(path)):
            found.paths[run] = path
        else:
            found.failed[run] = "runs away"
    return found
