"""Runs side by side: those that differ in the seed alone are one group, whose success is a mean with a band."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from manyhands.training.recorder import read_rows
from manyhands.training.run_folder import RunFolder

Array = NDArray[np.float64]
Along = Literal["steps", "seconds"]
Band = Literal["bootstrap", "range"]

_RESAMPLES = 10_000  # of the bootstrap: its limits scatter by less than 0.1 % of success
_PLACES = 200  # at least along a curve, for between evaluations a band is no straight line
# From which the policy follows. It does not from where training would have had to stop, nor from the trainer's threads.
_SETTINGS = ("num_envs", "workers", "randomize", "cameras")
_NO_SETTINGS = ("seed", "num_threads")  # of the trainer: a group holds all seeds


@dataclass(frozen=True)
class Run:
    """What a run folder says of success without exploration, at each evaluation and after training."""

    path: Path
    env_id: str
    seed: int
    settings: dict[str, Any]  # all from which the policy follows, but the seed
    steps: Array  # (k) of the environment, over all worlds
    seconds: Array  # (k) of training, evaluations included
    success: Array  # (k)
    is_done: bool  # its last point is the evaluation after training

    @property
    def last(self) -> float:
        """Success in the end, as far as it got."""
        return float(self.success[-1])

    def places(self, along: Along) -> Array:
        """Where it was evaluated (k)."""
        return self.steps if along == "steps" else self.seconds

    def is_again(self, other: "Run") -> bool:
        """Whether it is the other once more, as a copy of its folder is: the same seed, and the same success at all
        evaluations while both were training. (Steps are those at which a row was written, which is chance.)"""
        if self.seed != other.seed:
            return False
        both = min(len(self.steps) - self.is_done, len(other.steps) - other.is_done)
        places = slice(both or None)  # all, of a run that was evaluated after training alone
        return np.array_equal(self.success[places], other.success[places])


@dataclass(frozen=True)
class Group:
    """Runs of the same settings."""

    label: str
    runs: list[Run]

    @property
    def done(self) -> list[Run]:
        """Those that have been trained to the end."""
        return [run for run in self.runs if run.is_done]

    @property
    def counted(self) -> list[Run]:
        """Those of which the mean is: the ones that are done, and where there are none, all."""
        return self.done or self.runs

    def curves(self, along: Along) -> tuple[Array, Array]:
        """Places along the axis (k), and the success there of each run that counts (runs, k), linear between its
        evaluations.

        A run that is done keeps its success to the end; where none is done, all stop with the first that stops.
        """
        runs = self.counted
        places = [run.places(along) for run in runs]
        first = max(x[0] for x in places)
        last = max(first, (max if self.done else min)(x[-1] for x in places))
        x = np.unique(np.clip(np.concatenate([*places, np.linspace(first, last, _PLACES)]), first, last))
        return x, np.array([np.interp(x, at, run.success) for at, run in zip(places, runs, strict=True)])

    def single(self, along: Along) -> list[tuple[Run, Array, Array]]:
        """Each run, and its own curve: places (k) and success (k)."""
        x, curves = self.curves(along)
        done = [(run, x, curve) for run, curve in zip(self.counted, curves, strict=True) if run.is_done]
        return done + [(run, run.places(along), run.success) for run in self.runs if not run.is_done]


def interval(values: Array, band: Band) -> tuple[Array, Array]:
    """Limits (k) around the mean of the rows of (runs, k): the 95 % bootstrap interval of the mean over runs, always by
    the same resamples; or the least and the greatest."""
    if band == "range":
        return values.min(axis=0), values.max(axis=0)
    count = len(values)
    drawn = np.random.default_rng(0).multinomial(count, np.full(count, 1 / count), _RESAMPLES)
    low, high = np.percentile(drawn @ values / count, [2.5, 97.5], axis=0)
    return low, high


def read_groups(paths: Sequence[Path]) -> tuple[list[Group], list[str]]:
    """The runs in these folders, and in folders of runs among them, in the order given; and a line about each that is
    left out.

    Raises ValueError on a folder without runs, if no run has an evaluation, and on runs of several environments.
    """
    folders = dict.fromkeys(folder.resolve() for path in paths for folder in _run_folders(path))
    runs: list[Run] = []
    left_out: list[str] = []
    for folder in folders:
        run = _read_run(RunFolder(folder))
        if run is None:
            left_out.append(f"Left out, without an evaluation yet: {folder}")
        else:
            runs.append(run)
    if not runs:
        raise ValueError(f"no run in {', '.join(map(str, paths))} has an evaluation yet: there is nothing to compare")
    for run in runs:
        if run.env_id != runs[0].env_id:
            raise ValueError(
                f"runs of one environment can be compared: {runs[0].path} learned {runs[0].env_id}, "
                f"{run.path} {run.env_id}"
            )
    groups = _grouped(runs)
    for group in groups:
        left_out += _drop_repeated(group.runs)
    return groups, left_out


def _drop_repeated(runs: list[Run]) -> list[str]:
    """Of runs that are the same one keeps the one that got farthest. Returns a line about each of the others."""
    kept: list[Run] = []
    lines: list[str] = []
    for run in sorted(runs, key=lambda run: (run.is_done, run.steps[-1]), reverse=True):
        same = next((other for other in kept if run.is_again(other)), None)
        if same is None:
            kept.append(run)
        else:
            runs.remove(run)
            lines.append(f"Counted once, the same run of seed {run.seed} as {same.path}: {run.path}")
    return lines


def _grouped(runs: Sequence[Run]) -> list[Group]:
    by_settings: dict[str, list[Run]] = {}
    for run in runs:
        by_settings.setdefault(json.dumps(run.settings, sort_keys=True), []).append(run)
    groups = list(by_settings.values())
    differing = _differing([members[0].settings for members in groups])
    return [Group(_label(members[0].settings, differing), members) for members in groups]


def _run_folders(path: Path) -> list[Path]:
    """The run folder itself, or those in it."""
    if not path.is_dir():
        raise ValueError(f"there is no folder {path}")
    if RunFolder(path).config.is_file():
        return [path]
    found = sorted(run for run in path.iterdir() if RunFolder(run).config.is_file() and not run.name.startswith("."))
    if not found:
        raise ValueError(f"{path} is no run folder and holds none")
    return found


def _read_run(folder: RunFolder) -> Run | None:
    """None if it has no evaluation yet. Raises ValueError on damaged files."""
    settings, success, rows = folder.read_settings(), folder.read_success(), read_rows(folder)
    points: dict[int, tuple[float, float]] = {}
    evaluations = 0
    for row in rows:
        if row.evaluations > evaluations:
            evaluations = row.evaluations
            points[row.env_steps] = row.seconds, row.evaluation_success_rate
    if success is not None and rows:
        points[rows[-1].env_steps] = rows[-1].seconds, success
    if not points:
        return None
    trainer = {name: value for name, value in folder.read_trainer().items() if name not in _NO_SETTINGS}
    seconds, rates = zip(*points.values(), strict=True)
    return Run(
        path=folder.path,
        env_id=settings.env_id,
        seed=settings.seed,
        settings={name: getattr(settings, name) for name in _SETTINGS} | trainer,
        steps=np.array(list(points), float),
        seconds=np.array(seconds, float),
        success=np.array(rates, float),
        is_done=success is not None,
    )


def _differing(settings: Sequence[dict[str, Any]]) -> list[str]:
    """Names under which not all have the same."""
    names = dict.fromkeys(name for one in settings for name in one)
    return [name for name in names if any(one.get(name) != settings[0].get(name) for one in settings)]


def _label(settings: dict[str, Any], names: Sequence[str]) -> str:
    return ", ".join(f"{name}={_text(settings.get(name))}" for name in names) or "all runs"


def _text(value: Any) -> str:
    if isinstance(value, dict):  # ranges and cameras are too many to be told
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
