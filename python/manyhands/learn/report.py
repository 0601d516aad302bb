"""Shows how a training goes on: a bar, or plain lines."""

import time
from types import TracebackType
from typing import Protocol

from manyhands._core.learn import TrainMetrics
from manyhands.extras import needs
from manyhands.training.console import clock, counted

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
    return "  ".join([f"{model.metrics.env_steps:,} steps", _speed(model), *_episodes(model), *_reached(model)])


def _speed(model: Reported) -> str:
    metrics = model.metrics
    seconds = max(metrics.collect_seconds + metrics.learn_seconds, 1e-9)
    return f"{metrics.env_steps / seconds:,.0f} steps/s"


def _episodes(model: Reported) -> list[str]:
    return [counted(model.metrics.episodes, "episode")]


def _reached(model: Reported) -> list[str]:
    metrics = model.metrics
    parts = [f"mean return {metrics.mean_return:.4g}" if metrics.episodes else "mean return -"]
    if model.has_success:
        parts.append(f"success {metrics.success_rate:.0%}" if metrics.episodes else "success -")
    return parts


def _figures(model: Reported, left: str) -> list[str]:
    """What stands beside the bar: all of it, and shorter texts for narrow terminals."""
    reached = _reached(model)
    parts = ([_speed(model), *_episodes(model), *reached], [_speed(model), *reached], reached, reached[-1:], [])
    return ["  ".join([*some, left]) for some in parts]


class Report:
    """A context: `show` after each piece of training; at the end it shows where training came to."""

    def __init__(self, model: Reported, end: int, bar: bool, lines: bool) -> None:
        """end: `num_timesteps` at the end. bar: wanted; else lines, if these are."""
        self._model = model
        self._begin = model.num_timesteps
        self._lines = lines and not bar
        self._started = self._last_line = time.monotonic()
        self._total = end - self._begin
        self._bar = None
        if bar:
            with needs("train", "a progress bar"):
                from rich.console import Console

                from manyhands.training.bar import Bar
            self._bar = Bar(Console(), "training", self._total)

    def show(self) -> None:
        """Shows where training stands, if that is due."""
        if self._bar is not None:
            self._update_bar()
        elif self._lines and time.monotonic() - self._last_line > _SECONDS_BETWEEN_LINES:
            self._print()

    def _update_bar(self) -> None:
        assert self._bar is not None
        done = self._model.num_timesteps - self._begin
        seconds = (time.monotonic() - self._started) / max(done, 1) * max(self._total - done, 0)
        self._bar.show(done, self._total, _figures(self._model, f"{clock(seconds)} left"))

    def _print(self) -> None:
        self._last_line = time.monotonic()
        print(line(self._model), flush=True)

    def __enter__(self) -> "Report":
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._update_bar()
            self._bar.stop()
        elif self._lines:
            self._print()
