"""Shows how a training goes on: a bar on a terminal, plain lines elsewhere."""

import math
import time
from types import TracebackType
from typing import TYPE_CHECKING

from manyhands.training.console import Console, clock, counted
from manyhands.training.recorder import Row

if TYPE_CHECKING:
    from manyhands.training.bar import Bar

_SECONDS_BETWEEN_LINES = 2.0


def _speed(row: Row) -> float:
    return row.env_steps / max(row.seconds, 1e-9)


def _seconds_left(row: Row, env_steps: int) -> float:
    """Until so many steps, at the mean speed."""
    return max(env_steps - row.env_steps, 0) / max(_speed(row), 1.0)


def _percent(rate: float) -> str:
    return "-" if math.isnan(rate) else f"{rate:.0%}"


def _figures(row: Row, workers: str, left: str) -> list[str]:
    """Speed, success and time left: all that is known, and shorter texts for narrow terminals."""
    speed = f"{_speed(row):,.0f} steps/s"
    both = success = f"success {_percent(row.success_rate)}"
    if row.evaluations:
        success = f"success {row.evaluation_success_rate:.1%}"
        both += f", without exploration {row.evaluation_success_rate:.1%}"
    return [
        f"{speed}{workers}  {both}  {left}",
        f"{speed}{workers}  {success}  {left}",
        f"{success}  {left}",
        left,
    ]


def _bar(console: Console, env_id: str, total: int) -> "Bar":
    from manyhands.training.bar import Bar

    return Bar(console, env_id, total)


class TrainingProgress:
    """Context manager; `update` after each piece of training."""

    def __init__(
        self,
        console: Console,
        env_id: str,
        max_env_steps: int,
        expected_steps: int | None = None,
        workers: int | None = None,
    ) -> None:
        """expected_steps: in how many the task is known to be solved, None if it is not."""
        self._console = console
        self._expected = 0 if expected_steps is None else min(expected_steps, max_env_steps)
        self._workers = "" if workers is None else f" of {counted(workers, 'worker')}"
        self._limit = max_env_steps
        self._bar = _bar(console, env_id, self._expected or max_env_steps) if console.is_terminal else None
        self._last_line = 0.0

    def update(self, row: Row) -> None:
        """Shows where training stands."""
        in_time = row.env_steps <= self._expected
        total = self._expected if in_time else self._limit  # where training ends at the latest
        left = f"{'about' if in_time else '≤'} {clock(_seconds_left(row, total))} left"
        figures = _figures(row, self._workers, left)
        if self._bar is not None:
            self._bar.show(row.env_steps, total, figures)
        elif time.monotonic() - self._last_line >= _SECONDS_BETWEEN_LINES:
            self._last_line = time.monotonic()
            self._console.print(f"{row.env_steps:,} steps  {figures[0]}", highlight=False, soft_wrap=True)

    def say(self, text: str) -> None:
        """Prints a line above the bar."""
        self._console.print(text, highlight=False, markup=False, soft_wrap=True)

    def __enter__(self) -> "TrainingProgress":
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
