"""`python -m benchmarks.memory`: a million resets and steps with everything randomised, and what memory they take.

Ends with status 1 if the resident memory at the end of a run is more than a megabyte above that after its first tenth.
"""

import argparse
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import manyhands  # noqa: F401  (registers the ids)

TASKS = ("Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip")
WORLDS = 64
MOST_GROWTH = 1.0  # [MB]
EVERYTHING: dict[str, Any] = {
    "object_mass": (0.5, 2.0, "log"),
    "object_size": (0.8, 1.2),
    "object_friction": (0.5, 1.5),
    "table_friction": (0.5, 1.5),
    "finger_friction": (0.5, 1.5),
    "gravity": (0.95, 1.05),
    "joint_damping": (0.0, 2.0),
    "motor_gain": (0.7, 1.4, "log"),
    "motor_force": (0.7, 1.0),
    "action_latency": (0, 3),
    "action_noise": (0.0, 0.1),
    "observation_noise": (0.0, 0.01),
}


@dataclass
class Use:
    """Resident memory [MB] of the process: after the first tenth of a run, at its end, and the most in between."""

    early: float
    late: float
    most: float
    seconds: float

    @property
    def growth(self) -> float:
        """From the first tenth to the end [MB]."""
        return self.late - self.early


def resident() -> float:
    """Of this process [MB]; Linux only."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def measure(run: Callable[[int], None], count: int) -> Use:
    """`run(n)` does n of whatever is counted; ten times a tenth of `count`."""
    start, sizes = time.perf_counter(), []
    for _ in range(10):
        run(count // 10)
        sizes.append(resident())
    return Use(sizes[0], sizes[-1], max(sizes), time.perf_counter() - start)


def single(task: str) -> Callable[[int], None]:
    """A reset and a step of one environment, so many times."""
    env: Any = gymnasium.make(f"Panda{task}-v3", randomize=EVERYTHING)
    actions = np.random.default_rng(0).uniform(-1, 1, (100, *env.action_space.shape)).astype(np.float32)

    def run(count: int) -> None:
        for i in range(count):
            env.reset()
            env.step(actions[i % 100])

    return run


def vector(task: str) -> Callable[[int], None]:
    """The same of many worlds at once: `count` of each in all."""
    envs: Any = gymnasium.make_vec(
        f"Panda{task}-v3", num_envs=WORLDS, num_threads=2, autoreset_mode="SameStep", randomize=EVERYTHING
    )
    envs.reset(seed=0)
    actions = np.random.default_rng(0).uniform(-1, 1, (100, *envs.action_space.shape)).astype(np.float32)

    def run(count: int) -> None:
        for i in range(count // WORLDS):
            envs.step(actions[i % 100])
            envs.reset()

    return run


def made(task: str) -> Callable[[int], None]:
    """Environments made, reset, stepped and dropped."""

    def run(count: int) -> None:
        for _ in range(count):
            vector(task)(WORLDS)

    return run


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs everything; returns the exit status."""
    parser = argparse.ArgumentParser("python -m benchmarks.memory", description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000, help="resets and steps of each run (%(default)s)")
    count = parser.parse_args(arguments).count
    print(f"{'run':30}{'count':>10}{'seconds':>9}{'MB early':>10}{'most':>8}{'late':>8}{'growth':>9}")
    flat = True
    runs = [(f"{task}, make_vec of {WORLDS}", vector(task), count) for task in TASKS]
    runs += [("Push, make", single("Push"), count // 5), ("Push, made and dropped", made("Push"), count // 400)]
    for name, run, n in runs:
        use = measure(run, n)
        flat = flat and use.growth <= MOST_GROWTH
        print(
            f"{name:30}{n:>10,}{use.seconds:>9.1f}{use.early:>10.1f}{use.most:>8.1f}{use.late:>8.1f}{use.growth:>9.2f}",
            flush=True,
        )
    print("flat" if flat else f"NOT FLAT: more than {MOST_GROWTH:g} MB")
    return 0 if flat else 1


if __name__ == "__main__":
    sys.exit(main())
