"""Shows how a training goes on: a bar, or plain lines."""

import time
from types import TracebackType
from typing import Protocol

from manyhands._core.learn import TrainMetrics
from manyhands.extras import needs

_SECONDS_BETWEEN_LINES = 2.0


class Reported(Protocol):
    """What is shown of a model."""

    @property
    def metrics(self) -> TrainMetrics: ...
    @property
    def has_success(self) -> bool: ...
    @property
    def num_timesteps(self) -> int: ...


def line(model: Reported) -> str:
    """Where a training stands; success where its environment knows of any."""
    metrics = model.metrics
    seconds = max(metrics.collect_seconds + metrics.learn_seconds, 1e-9)
    parts = [
        f"{metrics.env_steps:,} steps",
        f"{metrics.env_steps / seconds:,.0f} steps/s",
        f"{metrics.episodes:,} episodes",
        f"mean return {metrics.mean_return:.4g}" if metrics.episodes else "mean return -",
    ]
    if model.has_success:
        parts.append(f"success {metrics.success_rate:.0%}" if metrics.episodes else "success -")
    return "  ".join(parts)


class Report:
    """A context: `show` after each piece of training; at the end it shows where training came to."""

    def __init__(self, model: Reported, end: int, bar: bool, lines: bool) -> None:
        """end: `num_timesteps` at the end. bar: wanted; else lines, if these are."""
        self._model = model
        self._begin = model.num_timesteps
        self._lines = lines and not bar
        self._last_line = time.monotonic()
        self._progress = None
        if bar:
            with needs("train", "a progress bar"):
                from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
            text = TextColumn("{task.fields[text]}")
            self._progress = Progress(BarColumn(20), TextColumn("{task.percentage:.0f} %"), TimeRemainingColumn(), text)
            self._task = self._progress.add_task("training", total=end - self._begin, text="")

    def show(self) -> None:
        """Shows where training stands, if that is due."""
        if self._progress is not None:
            self._update_bar()
        elif self._lines and time.monotonic() - self._last_line > _SECONDS_BETWEEN_LINES:
            self._print()

    def _update_bar(self) -> None:
        assert self._progress is not None
        self._progress.update(self._task, completed=self._model.num_timesteps - self._begin, text=line(self._model))

    def _print(self) -> None:
        self._last_line = time.monotonic()
        print(line(self._model), flush=True)

    def __enter__(self) -> "Report":
        if self._progress is not None:
            self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._progress is not None:
            self._update_bar()
            self._progress.stop()
        elif self._lines:
            self._print()
