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
_NO_SETTINGS = ("seed", "num_threads")  # of the trainer: a group holds all seeds, and threads change no result


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


@dataclass(frozen=True)
class Group:
    """Runs of the same settings."""

    label: str
    runs: list[Run]

    @property
    def done(self) -> int:
        """How many have been trained to the end."""
        return sum(run.is_done for run in self.runs)

    def curves(self, along: Along) -> tuple[Array, Array]:
        """Places along the axis (k), and the success of each run there (runs, k), linear between its evaluations.

        A run that is done keeps its success to the end; where one that is not done stops, all stop.
        """
        places = [run.steps if along == "steps" else run.seconds for run in self.runs]
        first = max(x[0] for x in places)
        stops = [x[-1] for x, run in zip(places, self.runs, strict=True) if not run.is_done]
        last = max(first, min(stops, default=max(x[-1] for x in places)))
        x = np.unique(np.clip(np.concatenate([*places, np.linspace(first, last, _PLACES)]), first, last))
        return x, np.array([np.interp(x, at, run.success) for at, run in zip(places, self.runs, strict=True)])


def interval(values: Array, band: Band) -> tuple[Array, Array]:
    """Limits (k) around the mean of the rows of (runs, k): the 95 % bootstrap interval of the mean over runs, always by
    the same resamples; or the least and the greatest."""
    if band == "range":
        return values.min(axis=0), values.max(axis=0)
    count = len(values)
    drawn = np.random.default_rng(0).multinomial(count, np.full(count, 1 / count), _RESAMPLES)
    low, high = np.percentile(drawn @ values / count, [2.5, 97.5], axis=0)
    return low, high


def read_groups(paths: Sequence[Path]) -> tuple[list[Group], list[Path]]:
    """The runs in these folders, and in folders of runs among them, in the order given; and those in folders of runs
    that are left out, since they have no evaluation yet.

    Raises ValueError on a folder without runs, a named run without an evaluation, and runs of several environments.
    """
    folders: dict[Path, bool] = {}  # whether it was named
    for path in paths:
        folders |= {folder.resolve(): folder == path for folder in _run_folders(path)}
    runs: list[Run] = []
    left_out: list[Path] = []
    for folder, is_named in folders.items():
        run = _read_run(RunFolder(folder))
        if run is not None:
            runs.append(run)
        elif is_named:
            raise ValueError(f"{folder} has no evaluation yet, so there is nothing to compare: leave it out")
        else:
            left_out.append(folder)
    if not runs:
        raise ValueError(f"no run in {', '.join(map(str, paths))} has an evaluation yet: there is nothing to compare")
    for run in runs:
        if run.env_id != runs[0].env_id:
            raise ValueError(
                f"runs of one environment can be compared: {runs[0].path} learned {runs[0].env_id}, "
                f"{run.path} {run.env_id}"
            )
    return _grouped(runs), left_out


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
    found = sorted(inner for inner in path.iterdir() if RunFolder(inner).config.is_file())
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
        settings={"num_envs": settings.num_envs, "max_env_steps": settings.max_env_steps} | trainer,
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
    return f"{value:g}" if isinstance(value, float) else str(value)
