"""Tasks, each in a process of its own: what crashes or hangs is a result, not the end."""

import multiprocessing
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

T = TypeVar("T")
Say = Callable[[Any], None]


@dataclass
class Ended(Generic[T]):
    """A task that is over. `said`: what it told on its way, in order; `status`: of its process, None out of time."""

    task: T
    said: list[Any]
    status: int | None


@dataclass
class Running(Generic[T]):
    """A task at work."""

    task: T
    process: BaseProcess
    answer: Connection
    deadline: float
    said: list[Any] = field(default_factory=list)


def run_all(
    tasks: Sequence[T],
    work: Callable[[Say, T], None],
    patience: Callable[[T], float],
    jobs: int,
    finished: Callable[[Ended[T]], None],
    started: Callable[[Sequence[T]], None],
    preload: Sequence[str] = (),
) -> None:
    """Runs `jobs` at a time; ends the children when interrupted.

    work: what a child does, with a function that tells its parent something; patience: seconds on the clock until a
    child is given up; started: gets what is at work whenever a task begins; preload: modules that all children need.
    """
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(preload))
    waiting, running = list(tasks), list[Running[T]]()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                task = waiting.pop(0)
                running.append(start(context, work, task, patience(task)))
                started([one.task for one in running])
            wait([one.answer for one in running], timeout=1.0)
            for one in list(running):
                ended = collect(one)
                if ended is not None:
                    running.remove(one)
                    finished(ended)
    finally:
        for one in running:
            one.process.kill()


def live(answer: Connection, work: Callable[[Say, T], None], task: T) -> None:
    """The child's life."""
    work(answer.send, task)
    answer.close()


def start(context: Any, work: Callable[[Say, T], None], task: T, patience: float) -> Running[T]:
    """One child."""
    receive, send = context.Pipe(duplex=False)
    process = context.Process(target=live, args=(send, work, task), daemon=True)
    process.start()
    send.close()
    return Running(task, process, receive, time.monotonic() + patience)


def collect(one: Running[T]) -> Ended[T] | None:
    """Takes what the child says; how it ended, if it has."""
    try:
        while one.answer.poll():
            one.said.append(one.answer.recv())
    except (EOFError, OSError):
        one.process.join()
        return Ended(one.task, one.said, one.process.exitcode)
    if time.monotonic() < one.deadline:
        return None
    one.process.kill()
    one.process.join()
    return Ended(one.task, one.said, None)
