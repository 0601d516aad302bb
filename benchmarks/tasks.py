"""Environment steps per second of the six tasks, through Gymnasium, beside panda-gym's: at random, and with experts.

After the timed rounds, the observations of our environments are compared with a replay of all their steps in another
number type: a wrong environment gets no figure, however fast it was.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from benchmarks.accuracy.quiet import quiet
from benchmarks.rows import Contender, Row, calibrate, measure_in_turns
from manyhands._core.envs import NATIVE_LANES, AutoresetBatch, AutoresetMode, make_env_batch
from manyhands.envs import Expert, register

TASKS = ("Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip")
POLICIES = ("random", "expert")
UNIT = "env steps/s"
ENV_STEP = 0.04  # [s] simulated
ACTIONS = 50  # random ones, before the first comes again
REPLAYED_WORLDS = 32  # of a batch, from the first on: the rest is compared between 1 and 2 threads
WORLDS = 1024

Observation = dict[str, NDArray[np.float32]]
Policy = Callable[[Observation, int], NDArray[np.float32]]  # of an observation and the number of steps so far


@dataclass
class Worlds:
    """One environment or batch of ours or of a peer, who acts in it, and what it observed last."""

    env_id: str
    worlds: int
    policy: str
    observation: Observation
    step: Callable[[NDArray[np.float32]], Observation]
    act: Policy
    steps: int = 0

    def run(self, calls: int) -> None:
        """`calls` steps of every world."""
        for _ in range(calls):
            self.observation = self.step(self.act(self.observation, self.steps))
            self.steps += 1

    def rows(self, worlds: int) -> NDArray[np.float32]:
        """The last observation of the first worlds, all parts side by side."""
        return np.hstack([np.atleast_2d(part)[:worlds] for part in self.observation.values()])


def env_id(task: str) -> str:
    """The id of a task under end-effector control."""
    return f"Panda{task}-v3"


def random_actions(worlds: int, size: int) -> NDArray[np.float32]:
    """(ACTIONS, worlds, size), the same for every run with this many worlds."""
    return np.random.default_rng(worlds).uniform(-1, 1, (ACTIONS, worlds, size)).astype(np.float32)


def policy_of(name: str, task: str, worlds: int, size: int) -> Policy:
    """Actions (worlds, size) for what is observed: random ones in a circle, or the expert's."""
    if name == "expert":
        expert = Expert(env_id(task))
        return lambda observation, _: np.atleast_2d(expert(observation))
    actions = random_actions(worlds, size)
    return lambda _, steps: actions[steps % ACTIONS]


def vector_env(task: str, policy: str, worlds: int, threads: int) -> Worlds:
    """`gymnasium.make_vec`; a finished world starts anew within the step that ended its episode."""
    envs: Any = gymnasium.make_vec(env_id(task), num_envs=worlds, num_threads=threads, autoreset_mode="SameStep")
    act = policy_of(policy, task, worlds, envs.single_action_space.shape[0])
    return Worlds(env_id(task), worlds, policy, envs.reset(seed=0)[0], lambda action: envs.step(action)[0], act)


def one_env(task: str, policy: str, env: Any) -> Worlds:
    """A single environment, ours or a peer's."""
    act = policy_of(policy, task, 1, env.action_space.shape[0])
    return Worlds(env_id(task), 1, policy, env.reset(seed=0)[0], lambda action: step_and_reset(env, action[0]), act)


def step_and_reset(env: Any, action: NDArray[np.float32]) -> Observation:
    """One step; the next episode's first observation where it was the last."""
    observation, _, terminated, truncated, _ = env.step(action)
    return env.reset()[0] if terminated or truncated else observation


def panda_gym_env(task: str, policy: str) -> Worlds:
    """panda-gym's environment, under an id that does not collide with ours. Raises ImportError without it."""
    with warnings.catch_warnings(), quiet():
        warnings.simplefilter("ignore")
        import panda_gym  # noqa: F401
        from panda_gym.pybullet import PyBullet

        register()  # panda-gym has just taken our ids
        if task == "Flip":  # its wheel lacks the picture on the cube, without which it cannot be made
            with_picture = PyBullet.create_box
            PyBullet.create_box = lambda self, *a, texture=None, **k: with_picture(self, *a, **k)
        steps = gymnasium.spec(env_id(task)).max_episode_steps
        spec = EnvSpec(f"panda-gym/{env_id(task)}", f"panda_gym.envs:Panda{task}Env", max_episode_steps=steps)
        return one_env(task, policy, gymnasium.make(spec))


def replay(run: Worlds, worlds: int, lanes: int) -> NDArray[np.float32]:
    """The rows that `run` must have by now, from the same policy in another number type."""
    envs = make_env_batch(run.env_id, worlds, num_threads=1, lanes=lanes)
    batch = AutoresetBatch(envs, AutoresetMode.SAME_STEP, envs.spec.max_episode_steps)
    batch.reset(None, np.arange(worlds, dtype=np.uint64), np.ones(worlds, np.bool_))
    act = run.act if run.policy == "random" else policy_of("expert", run.env_id[5:-3], worlds, 0)
    for step in range(run.steps):
        observation, achieved, desired = batch.observations()
        seen = {"observation": observation, "achieved_goal": achieved, "desired_goal": desired}
        batch.step(np.ascontiguousarray(act(seen, step)[:worlds]))
    return np.hstack(batch.observations())


def run_tasks(tasks: Sequence[str], rounds: int, seconds: float) -> list[Row]:
    """panda-gym and our ways to step the tasks, in turns of about `seconds` each."""
    return [row for task in tasks for policy in POLICIES for row in run_task(task, policy, rounds, seconds)]


def run_task(task: str, policy: str, rounds: int, seconds: float) -> list[Row]:
    """One task under one policy."""

    def ours(name: str, threads: int, run: Worlds) -> tuple[Contender, Worlds]:
        row = Row(f"{task} {policy}, {name}", "manyhands", "float32", threads, None, UNIT)
        return Contender(row, run.run, units=run.worlds), run

    peer, panda_gym = panda_gym_contender(task, policy)
    pairs = [
        ours(f"make_vec of {WORLDS}", 1, vector_env(task, policy, WORLDS, 1)),
        ours(f"make_vec of {WORLDS}", 2, vector_env(task, policy, WORLDS, 2)),
    ]
    one, two = pairs
    if (task, policy) == ("Reach", "random"):
        pairs.append(ours("gymnasium.make", 1, one_env(task, policy, gymnasium.make(env_id(task)))))
        pairs += [ours(f"make_vec of {n}", 1, vector_env(task, policy, n, 1)) for n in (1, 64)]
    contenders = [contender for contender, _ in pairs]
    if panda_gym is not None:
        contenders.insert(0, panda_gym)
    calibrate(one[0], seconds)
    two[0].calls = one[0].calls
    two[1].run(one[1].steps - two[1].steps)
    measure_in_turns(contenders, rounds, seconds)

    for contender, run in pairs:
        fill(contender.row, peer.value)
        check(contender.row, run)
    if one[0].row.value and two[0].row.value:
        two[0].row.ratio, two[0].row.ratio_to = two[0].row.value / one[0].row.value, "1 thread"
    if not np.array_equal(one[1].rows(WORLDS), two[1].rows(WORLDS)):
        two[0].row.refuse("1 and 2 threads observe different things")
    fill(peer, None)
    return [peer, *(contender.row for contender, _ in pairs)]


def fill(row: Row, peer: float | None) -> None:
    """The ratio to panda-gym, and how much time is simulated in a second."""
    if row.value:
        row.note = f"{ENV_STEP * row.value:,.0f} simulated s/s"
        if peer:
            row.ratio, row.ratio_to = row.value / peer, "panda-gym"


def panda_gym_contender(task: str, policy: str) -> tuple[Row, Contender | None]:
    """panda-gym's row, and what fills it; None if panda-gym is not installed."""
    row = Row(f"{task} {policy}, one environment", "panda-gym 3.0.7", "double", 1, None, UNIT)
    try:
        run = panda_gym_env(task, policy)
    except ImportError as error:
        row.note = f"not installed: {error.name}"
        return row, None
    return row, Contender(row, run.run)


def check(row: Row, run: Worlds) -> None:
    """Refuses the row if a replay in another number type observes anything else."""
    worlds = min(run.worlds, REPLAYED_WORLDS)
    lanes = NATIVE_LANES if worlds == 1 else 1
    if not np.array_equal(run.rows(worlds).view(np.uint32), replay(run, worlds, lanes).view(np.uint32)):
        row.refuse(f"not the bits of a replay with lanes={lanes}")
