"""Scenes in a process of their own, with bounds on memory and processor time."""

import resource
from dataclasses import dataclass

from benchmarks.absurd.run import STEPS, run
from benchmarks.children import Say

MEMORY = 6 << 30  # [bytes] of addresses


@dataclass(frozen=True)
class Task:
    """Some scenes. `limit`: processor seconds of each; every `lanes`-th runs in single precision, too."""

    seed: int
    numbers: tuple[int, ...]
    limit: float
    lanes: int


def examine(say: Say, task: Task) -> None:
    """Tells the number of each scene before it begins, and its outcome after it."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for number in task.numbers:
        say({"began": number})
        used = resource.getrusage(resource.RUSAGE_SELF)
        until = int(used.ru_utime + used.ru_stime + task.limit) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (until, resource.RLIM_INFINITY))
        say(run(task.seed, number, STEPS, task.lanes > 0 and number % task.lanes == 0).words())
