"""Many trainings at once: every seed with every combination of settings, each in a process of its own."""

import itertools
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from manyhands.interrupts import Interrupts
from manyhands.training.recorder import Row, read_rows
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import TrainSettings

ERROR = "error:"  # begins the line of a log that says why a run has failed

State = Literal["waiting", "training", "done", "stopped", "failed"]


def grid(choices: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Every combination of one value for each name."""
    return [dict(zip(choices, values, strict=True)) for values in itertools.product(*choices.values())]


@dataclass
class SweepRun:
    """One training of a sweep, and where it stands."""

    folder: RunFolder
    settings: TrainSettings
    state: State = "waiting"
    error: str = ""
    row: Row | None = None  # the last of metrics.csv
    process: "subprocess.Popen[bytes] | None" = field(default=None, repr=False)

    @property
    def name(self) -> str:
        return self.folder.path.name

    def start(self) -> None:
        """Begins to train, or goes on from the folder's checkpoint."""
        command = [sys.executable, "-m", "manyhands.training.sweep_worker", str(self.folder.path)]
        try:
            with self.folder.log.open("wb") as log:
                self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log)
            self.state = "training"
        except OSError as reason:
            self._fail(str(reason))

    def look(self, stopping: bool) -> None:
        """Brings state and row up to date; a process that ends while all are stopping has not failed."""
        if self.process is None:
            return
        code = self.process.poll()
        try:
            self.row = (read_rows(self.folder) or [None])[-1]
        except (ValueError, OSError):
            self.row = None  # the process itself says what is wrong with the file
        if code is None:
            return
        self.process = None
        if code == 0:
            self.state = "done"
        elif stopping:
            self.state = "stopped"
        else:
            self._fail(_error_in(self.folder.log) or _ending(code))

    def stop(self) -> None:
        """Asks the process to save a checkpoint and end: it watches its input."""
        if self.process is not None and self.process.stdin is not None:
            self.process.stdin.close()

    def kill(self) -> None:
        """Ends the process at once."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.process, self.state = None, "stopped"

    def _fail(self, error: str) -> None:
        self.state, self.error = "failed", error


def prepare(
    parent: Path,
    settings_with: Callable[[dict[str, Any]], TrainSettings],
    choices: Mapping[str, Sequence[Any]],
    seeds: int,
) -> list[SweepRun]:
    """A folder in `parent` for each combination and seed, those that are there already included. `settings_with` gives
    the settings of a combination.

    Raises ValueError on settings that make no sense or differ from those of a run that is there, and on a folder of
    another task's runs, before it makes any; OSError if a folder cannot be made.
    """
    runs: list[SweepRun] = []
    for chosen in grid(choices):
        settings = settings_with(chosen)
        settings.trainer_config()
        for seed in range(seeds):
            wanted = replace(settings, seed=seed, num_threads=1)
            runs.append(SweepRun(RunFolder(parent / _folder_name(chosen, wanted)), wanted))
    _require_task(parent, runs[0].settings.env_id)
    there = [run for run in runs if run.folder.config.is_file()]
    for run in there:
        _require_same(run.folder, run.settings)
        run.state = "done" if run.folder.read_success() is not None else "waiting"
        run.row = (read_rows(run.folder) or [None])[-1] if run.state == "done" else None
    for run in runs:
        if not run.folder.config.is_file():
            run.folder.make(run.settings)
    return runs


def _folder_name(chosen: Mapping[str, Any], settings: TrainSettings) -> str:
    """Such as gamma=0.95,hidden_layers=64x64,seed=3, and randomize,seed=0."""
    parts = [f"{name}={_plain(value)}" for name, value in chosen.items()]
    return ",".join([*(["randomize"] if settings.randomize else []), *parts, f"seed={settings.seed}"])


def _plain(value: Any) -> str:
    text = "x".join(map(str, value)) if isinstance(value, list) else str(value)
    return re.sub(r"[^\w.+-]", "_", text)


def _require_task(parent: Path, env_id: str) -> None:
    for config in sorted(parent.glob("*/config.json")):
        there = RunFolder(config.parent).read_settings().env_id
        if there != env_id:
            raise ValueError(f"{parent} holds runs of {there}, wanted is {env_id}: name another folder with --out")


def _require_same(folder: RunFolder, wanted: TrainSettings) -> None:
    there, here = asdict(folder.read_settings()), asdict(wanted)
    there, here = ({**one, **one["overrides"]} for one in (there, here))
    for name in dict.fromkeys([*here, *there]):
        if name != "overrides" and there.get(name) != here.get(name):
            raise ValueError(
                f"{folder.path} holds a run with {name}={json.dumps(there.get(name))}, wanted is "
                f"{json.dumps(here.get(name))}: name another folder with --out"
            )


def _error_in(log: Path) -> str:
    try:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    return next((line.removeprefix(ERROR).strip() for line in lines if line.startswith(ERROR)), "")


def _ending(code: int) -> str:
    return f"the process ended with {code}" if code > 0 else f"the process was ended by {signal.Signals(-code).name}"


def default_jobs() -> int:
    """As many as there are cores for this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def advance(runs: Sequence[SweepRun], jobs: int, interrupts: Interrupts) -> bool:
    """Looks after the processes once: ends, starts. Returns whether there is more to wait for."""
    for run in runs:
        run.look(stopping=interrupts.requested)
    if interrupts.requested:
        for run in runs:
            run.stop()
    else:
        free = jobs - sum(run.state == "training" for run in runs)
        for run in [run for run in runs if run.state == "waiting"][:free]:
            run.start()
    waits = ("training",) if interrupts.requested else ("training", "waiting")
    return any(run.state in waits for run in runs)
