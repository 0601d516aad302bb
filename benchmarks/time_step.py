"""`python -m benchmarks.time_step`: what a longer time step costs in accuracy and brings in speed, task by task.

Experts act at 2 ms; their actions are then repeated at other time steps, a step of the environment being 40 ms always
and motors keeping their law in time. Errors are distances from the same actions at 0.25 ms, mean over the episode: the
median of all worlds and the value below which nine of ten are. `lost` are worlds in which a number stopped being
finite, `success` is that of the expert acting at that step.
Rates are those of the repeated actions through `gymnasium.make_vec` on one thread.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from manyhands.envs import Expert

TASKS = ("Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip")
ENV_STEP = 0.04  # [s]
USUAL, REFERENCE = 0.002, 0.00025  # [s]
TIME_STEPS = (0.001, 0.002, 0.004, 0.008)
ERRORS = ("hand, mm", "90 %", "objects, mm", "90 %")
HEADINGS = ("task", "step", *ERRORS, "lost", "success", "env steps/s", "simulated s/s")


@dataclass
class Paths:
    """What a run of all worlds saw, and how long it took."""

    hand: NDArray[np.float32]  # (steps, worlds, 3) [m]
    objects: NDArray[np.float32]  # (steps, worlds, objects, 3) [m]
    success: float  # share of the worlds that ever reached the goal
    seconds: float


def make(task: str, worlds: int, time_step: float) -> Any:
    """Worlds that go on after success."""
    return gymnasium.make_vec(
        f"Panda{task}-v3",
        num_envs=worlds,
        num_threads=1,
        max_episode_steps=-1,
        terminate_on_success=False,
        time_step=time_step,
        n_substeps=round(ENV_STEP / time_step),
        # A motor removes a tenth of its error in 2 ms, whatever the step.
        randomize={"motor_gain": (1 - 0.9 ** (time_step / USUAL)) / 0.1},
    )


def places(task: str, observation: NDArray[np.float32]) -> NDArray[np.float32]:
    """(worlds, objects, 3) of an observation (worlds, n)."""
    first = 7 if task in ("PickAndPlace", "Stack", "Flip") else 6
    starts = {"Reach": (), "Stack": (first, first + 12)}.get(task, (first,))
    parts = [observation[:, None, at : at + 3] for at in starts]
    return np.concatenate(parts, axis=1) if parts else np.empty((len(observation), 0, 3), np.float32)


def run(task: str, worlds: int, time_step: float, actions: Sequence[NDArray[np.float32]] | None) -> tuple[Any, Paths]:
    """An episode of every world under the actions, or under the expert; returns the actions too."""
    envs = make(task, worlds, time_step)
    steps = gymnasium.spec(f"Panda{task}-v3").max_episode_steps or 0
    expert, taken, hand, objects = Expert(f"Panda{task}-v3"), [], [], []
    observation, info = envs.reset(seed=0)
    success, lost, seconds = info["is_success"], np.zeros(worlds, np.bool_), 0.0
    for step in range(steps):
        taken.append(expert(observation) if actions is None else actions[step])
        start = time.perf_counter()
        observation, _, _, _, info = envs.step(taken[-1])
        seconds += time.perf_counter() - start
        lost |= info["unstable"]
        success = success | (info["is_success"] & ~lost)
        hand.append(np.where(lost[:, None], np.nan, observation["observation"][:, :3]))
        objects.append(places(task, observation["observation"]))
    return taken, Paths(np.array(hand), np.array(objects), float(success.mean()), seconds)


def apart(a: NDArray[np.float32], b: NDArray[np.float32]) -> tuple[str, str]:
    """The mean distance of two paths (steps, worlds, ..., 3) [mm]: median and ninth decile of the worlds."""
    if a.size == 0:
        return "", ""
    distance = 1e3 * np.linalg.norm(a - b, axis=-1).reshape(len(a), a.shape[1], -1).mean(axis=(0, 2))
    distance = np.sort(np.where(np.isfinite(distance), distance, np.inf))
    return f"{distance[len(distance) // 2]:.2f}", f"{distance[len(distance) * 9 // 10]:.2f}"


def compare(task: str, worlds: int) -> list[tuple[str, ...]]:
    """The rows of a task."""
    actions, _ = run(task, worlds, USUAL, None)
    _, reference = run(task, worlds, REFERENCE, actions)
    rows = []
    for time_step in TIME_STEPS:
        _, paths = run(task, worlds, time_step, actions)
        _, acting = run(task, worlds, time_step, None)
        rate = worlds * len(actions) / paths.seconds
        rows.append(
            (
                task,
                f"{1e3 * time_step:g} ms",
                *apart(paths.hand, reference.hand),
                *apart(paths.objects, reference.objects),
                str(np.count_nonzero(~np.isfinite(paths.hand[-1]).all(axis=-1))),
                f"{100 * acting.success:.0f} %",
                f"{rate:,.0f}",
                f"{ENV_STEP * rate:,.0f}",
            )
        )
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table, as Markdown; returns the exit status."""
    parser = argparse.ArgumentParser("python -m benchmarks.time_step", description=__doc__)
    parser.add_argument("--worlds", type=int, default=256, help="of each task (%(default)s)")
    parser.add_argument("--tasks", nargs="*", default=TASKS, help="(all)")
    options = parser.parse_args(arguments)
    print(f"| {' | '.join(HEADINGS)} |\n|{' --- |' * len(HEADINGS)}", flush=True)
    for task in options.tasks:
        for row in compare(task, options.worlds):
            print(f"| {' | '.join(row)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
