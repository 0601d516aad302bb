"""Environment steps per second of Reach, through Gymnasium, beside panda-gym's.

After the timed rounds, the observations of our environments are compared with a replay of the same actions in another
number type: a wrong environment gets no figure, however fast it was.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from benchmarks.rows import Contender, Row, calibrate, measure_in_turns
from manyhands._core.envs import AutoresetBatch, AutoresetMode, make_env_batch
from manyhands.envs import register

ENV_ID = "PandaReach-v3"
UNIT = "env steps/s"
EPISODE_STEPS = 50
REPLAYED_WORLDS = 32  # of a batch, from the first on: the rest is compared between 1 and 2 threads
WORLDS = 1024


@dataclass
class Reach:
    """One environment or batch of ours, the actions it takes in a circle, and what it observed last."""

    step: Callable[[NDArray[np.float32]], dict[str, NDArray[np.float32]]]
    actions: NDArray[np.float32]  # (steps, worlds, 3)
    steps: int = 0
    observation: dict[str, NDArray[np.float32]] | None = None

    def run(self, calls: int) -> None:
        """`calls` steps of every world."""
        for _ in range(calls):
            self.observation = self.step(self.actions[self.steps % len(self.actions)])
            self.steps += 1

    def rows(self, worlds: int) -> NDArray[np.float32]:
        """The last observation of the first worlds, all parts side by side."""
        assert self.observation is not None
        return np.hstack([np.atleast_2d(part)[:worlds] for part in self.observation.values()])


def random_actions(worlds: int) -> NDArray[np.float32]:
    """(steps, worlds, 3), the same for every run with this many worlds."""
    return np.random.default_rng(worlds).uniform(-1, 1, (EPISODE_STEPS, worlds, 3)).astype(np.float32)


def vector_env(worlds: int, threads: int) -> Reach:
    """`gymnasium.make_vec`; a finished world starts anew within the step that ended its episode."""
    envs: Any = gymnasium.make_vec(ENV_ID, num_envs=worlds, num_threads=threads, autoreset_mode="SameStep")
    envs.reset(seed=0)
    return Reach(lambda action: envs.step(action)[0], random_actions(worlds))


def single_env() -> Reach:
    """`gymnasium.make`."""
    env: Any = gymnasium.make(ENV_ID)
    env.reset(seed=0)
    return Reach(lambda action: step_and_reset(env, action[0]), random_actions(1))


def panda_gym_env() -> Reach:
    """panda-gym's environment, under an id that does not collide with ours. Raises ImportError without it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import panda_gym  # noqa: F401

        register()  # panda-gym has just taken our ids
    spec = EnvSpec("panda-gym/PandaReach-v3", "panda_gym.envs:PandaReachEnv", max_episode_steps=EPISODE_STEPS)
    env: Any = gymnasium.make(spec)
    env.reset(seed=0)
    return Reach(lambda action: step_and_reset(env, action[0]), random_actions(1))


def step_and_reset(env: Any, action: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
    """One step; the next episode's first observation where it was the last."""
    observation, _, terminated, truncated, _ = env.step(action)
    return env.reset()[0] if terminated or truncated else observation


def replay(reach: Reach, worlds: int, lanes: int) -> NDArray[np.float32]:
    """The rows that `reach` must have by now, from the same actions in another number type."""
    envs = make_env_batch(ENV_ID, worlds, num_threads=1, lanes=lanes)
    batch = AutoresetBatch(envs, AutoresetMode.SAME_STEP, EPISODE_STEPS)
    batch.reset(None, np.arange(worlds, dtype=np.uint64), np.ones(worlds, np.bool_))
    for step in range(reach.steps):
        batch.step(np.ascontiguousarray(reach.actions[step % len(reach.actions), :worlds]))
    return np.hstack(batch.observations())


def run_reach(rounds: int, seconds: float) -> list[Row]:
    """panda-gym and all our ways to step Reach, in turns of about `seconds` each."""

    def ours(name: str, threads: int, reach: Reach) -> tuple[Contender, Reach]:
        row = Row(name, "manyhands", "float32", threads, None, UNIT)
        return Contender(row, reach.run, units=reach.actions.shape[1]), reach

    peer, panda_gym = panda_gym_contender()
    pairs = [
        ours("Reach, gymnasium.make", 1, single_env()),
        ours("Reach, make_vec of 1", 1, vector_env(1, 1)),
        ours("Reach, make_vec of 64", 1, vector_env(64, 1)),
        ours(f"Reach, make_vec of {WORLDS}", 1, vector_env(WORLDS, 1)),
        ours(f"Reach, make_vec of {WORLDS}", 2, vector_env(WORLDS, 2)),
    ]
    contenders = [contender for contender, _ in pairs]
    if panda_gym is not None:
        contenders.insert(0, panda_gym)
    one, two = (pairs[-2], pairs[-1])
    calibrate(one[0], seconds)
    two[0].calls = one[0].calls
    two[1].run(one[1].steps - two[1].steps)
    measure_in_turns(contenders, rounds, seconds)

    for contender, _ in pairs:
        if peer.value and contender.row.value:
            contender.row.ratio, contender.row.ratio_to = contender.row.value / peer.value, "panda-gym"
    if one[0].row.value and two[0].row.value:
        two[0].row.ratio, two[0].row.ratio_to = two[0].row.value / one[0].row.value, "1 thread"
    for contender, reach in pairs:
        check(contender.row, reach)
    if not np.array_equal(one[1].rows(WORLDS), two[1].rows(WORLDS)):
        two[0].row.refuse("1 and 2 threads observe different things")
    return [peer, *(contender.row for contender, _ in pairs)]


def panda_gym_contender() -> tuple[Row, Contender | None]:
    """panda-gym's row, and what fills it; None if panda-gym is not installed."""
    row = Row("Reach, one environment", "panda-gym 3.0.7", "double", 1, None, UNIT)
    try:
        reach = panda_gym_env()
    except ImportError as error:
        row.note = f"not installed: {error.name}"
        return row, None
    return row, Contender(row, reach.run)


def check(row: Row, reach: Reach) -> None:
    """Refuses the row if a replay in another number type observes anything else."""
    worlds = min(reach.actions.shape[1], REPLAYED_WORLDS)
    expected = replay(reach, worlds, lanes=4 if worlds == 1 else 1)
    if not np.array_equal(reach.rows(worlds).view(np.uint32), expected.view(np.uint32)):
        row.refuse(f"not the bits of a replay with lanes={4 if worlds == 1 else 1}")
