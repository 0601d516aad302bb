"""Runs cases, each in a process of its own: what crashes or hangs is a row, not the end."""

import multiprocessing
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any

from benchmarks.accuracy.case import Measurement
from benchmarks.accuracy.cases import CASES
from benchmarks.accuracy.engines.base import CannotRunError, OutOfTimeError, Settings
from benchmarks.accuracy.rows import INCOMPLETE, Row, rows_of, without_figure

PRELOAD = ["mujoco", "ours", "pybullet"]


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


@dataclass
class Running:
    """A task at work."""

    task: Task
    process: BaseProcess
    answer: Connection
    deadline: float


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


def work(answer: Connection, case: str, settings: Settings) -> None:
    """The child's life."""
    answer.send(measure(case, settings))
    answer.close()


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
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([f"benchmarks.accuracy.engines.{name}" for name in PRELOAD])
    waiting, running = list(tasks), list[Running]()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                running.append(start(context, waiting.pop(0)))
                started([one.task for one in running])
            wait([one.answer for one in running], timeout=1.0)
            for one in list(running):
                answer = collect(one)
                if answer is not None:
                    running.remove(one)
                    finished(one.task, rows_for(one.task, *answer))
    finally:
        for one in running:
            one.process.kill()


def start(context: Any, task: Task) -> Running:
    """One child. It may take ten times its budget: reading and looking take time too, and the machine may be busy."""
    receive, send = context.Pipe(duplex=False)
    process = context.Process(target=work, args=(send, task.case, task.settings), daemon=True)
    process.start()
    send.close()
    return Running(task, process, receive, time.monotonic() + patience(task))


def patience(task: Task) -> float:
    """Seconds on the clock until a child is given up."""
    return 60 + 10 * task.settings.budget


def collect(one: Running) -> tuple[str, Any] | None:
    """The child's answer, if it is there; or how it ended."""
    if one.answer.poll():
        try:
            answer = one.answer.recv()
        except EOFError:
            one.process.join()
            return "failed", f"the process ended with status {one.process.exitcode}"
        one.process.join()
        return answer
    if time.monotonic() > one.deadline:
        one.process.kill()
        return INCOMPLETE, f"{INCOMPLETE} after {patience(one.task):.0f} s on the clock"
    return None
