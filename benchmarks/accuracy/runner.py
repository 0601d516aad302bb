"""Runs cases, each in a process of its own: what crashes or hangs is a row, not the end."""

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks import children
from benchmarks.accuracy.case import Measurement
from benchmarks.accuracy.cases import CASES
from benchmarks.accuracy.engines.base import CannotRunError, OutOfTimeError, Settings
from benchmarks.accuracy.rows import INCOMPLETE, Row, rows_of, without_figure

PRELOAD = [f"benchmarks.accuracy.engines.{name}" for name in ("mujoco", "ours", "pybullet")]


@dataclass(frozen=True)
class Task:
    """A case under settings."""

    case: str
    settings: Settings

    @property
    def title(self) -> str:
        """For the progress bar."""
        s = self.settings
        return f"{self.case}, {s.engine}{' ' + s.variant if s.variant else ''}, {s.time_step * 1e3:g} ms"


def measure(case: str, settings: Settings) -> tuple[str, Any]:
    """("done", Measurement), or why not."""
    try:
        return "done", CASES[case].run(settings)
    except CannotRunError as why:
        return "cannot", str(why)
    except OutOfTimeError as why:
        return INCOMPLETE, str(why)
    except ModuleNotFoundError as why:
        return "cannot", f"{why.name} is not installed"
    except Exception as why:
        place = traceback.extract_tb(why.__traceback__)[-1]
        return "failed", f"{type(why).__name__}: {str(why).strip()[:200]} ({place.name})"


def work(say: children.Say, task: Task) -> None:
    """The child's life."""
    say(measure(task.case, task.settings))


def rows_for(task: Task, kind: str, result: Any) -> list[Row]:
    """What to write down."""
    case = CASES[task.case]
    if kind == "done":
        assert isinstance(result, Measurement)
        return rows_of(case, task.settings, result)
    note = result if kind == INCOMPLETE else f"{kind}: {result}"
    return [without_figure(case, task.settings, note, "" if kind == "cannot" else "fail")]


def run_all(
    tasks: Sequence[Task],
    jobs: int,
    finished: Callable[[Task, list[Row]], None],
    started: Callable[[Sequence[Task]], None],
) -> None:
    """Runs `jobs` at a time; ends the children when interrupted."""

    def over(ended: children.Ended[Task]) -> None:
        finished(ended.task, rows_for(ended.task, *answer(ended)))

    children.run_all(tasks, work, patience, jobs, over, started, PRELOAD)


def patience(task: Task) -> float:
    """Ten times the budget: reading and looking take time too, and the machine may be busy."""
    return 60 + 10 * task.settings.budget


def answer(ended: children.Ended[Task]) -> tuple[str, Any]:
    """What the child said, or how it ended."""
    if ended.said:
        return ended.said[0]
    if ended.status is None:
        return INCOMPLETE, f"{INCOMPLETE} after {patience(ended.task):.0f} s on the clock"
    return "failed", f"the process ended with status {ended.status}"
