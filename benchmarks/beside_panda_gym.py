"""Side by side with panda-gym itself: `python -m benchmarks.beside_panda_gym`.

Actions are recorded in panda-gym and replayed in the native environments under the same seeds; and policies act in both
for themselves. panda-gym's positions of links, which are one physics step old, are made current; it is otherwise as it
comes, unless a row says that its fingers are geared together as ours are. Each episode has a fresh panda-gym, since its
engine carries what it knows of contacts over a reset.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands.envs import ArmEnv, Expert

Array = NDArray[np.float64]
Observation = dict[str, Any]
Act = Callable[[Observation, int], Any]  # of an observation and the number of steps so far

TASKS = ("Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip")
OBJECT = {"Push": 6, "Slide": 6, "PickAndPlace": 7, "Stack": 7, "Flip": 7}  # where its position begins in a row
WANTED_RATE = 0.03  # greatest difference of success


@contextmanager
def _quiet() -> Iterator[None]:
    """PyBullet tells every new simulation's colours."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


@contextmanager
def panda_gym(task: str, geared: bool = False) -> Iterator[Any]:
    """A fresh environment, its links read as they are now; Flip without the picture that its wheel lacks."""
    from panda_gym.envs import panda_tasks
    from panda_gym.pybullet import PyBullet

    create_box = PyBullet.create_box
    PyBullet.create_box = lambda self, *args, texture=None, **kwargs: create_box(self, *args, **kwargs)
    try:
        with _quiet():
            env = getattr(panda_tasks, f"Panda{task}Env")()
    finally:
        PyBullet.create_box = create_box
    sim, client = env.sim, env.sim.physics_client

    def link_state(body: str, link: int) -> Any:
        return client.getLinkState(sim._bodies_idx[body], link, computeLinkVelocity=True, computeForwardKinematics=True)

    sim.get_link_position = lambda body, link: np.array(link_state(body, link)[0])
    sim.get_link_velocity = lambda body, link: np.array(link_state(body, link)[6])
    if geared:
        panda = sim._bodies_idx["panda"]
        gear = client.createConstraint(panda, 9, panda, 10, client.JOINT_GEAR, [1, 0, 0], [0, 0, 0], [0, 0, 0])
        client.changeConstraint(gear, gearRatio=-1, erp=0.1, maxForce=1000)
    env.touched = False

    def step() -> None:
        for _ in range(sim.n_substeps):
            client.stepSimulation()
            env.touched = env.touched or len(client.getContactPoints(sim._bodies_idx["panda"])) > 0

    sim.step = step
    try:
        yield env
    finally:
        env.close()


def reset(env: Any, task: str, seed: int) -> Observation:
    """Starts the same episode as ours: Flip's goal is not seeded in panda-gym 3.0.7, so it is given ours."""
    observation = env.reset(seed=seed)[0]
    ours = ArmEnv(f"Panda{task}").reset(seed=seed)[0]
    if task == "Flip":
        env.task.goal = ours["desired_goal"].astype(float)
        env.sim.set_base_pose("object", ours["observation"][7:10].astype(float), np.array([0.0, 0, 0, 1]))
        observation = env._get_obs()
    for key, value in ours.items():
        np.testing.assert_allclose(observation[key], value, atol=1e-4, err_msg=f"{task}, seed {seed}: {key}")
    return observation


@dataclass
class Path:
    actions: Array  # (steps, action size)
    rows: Array  # (steps + 1, observation size)
    free: NDArray[np.bool_]  # (steps) the arm had touched nothing yet
    success: bool

    def object_end(self, task: str) -> Array:
        """(3,) position in the end."""
        return self.rows[-1, OBJECT[task] : OBJECT[task] + 3]


def recorded(env: Any, observation: Observation, act: Act, steps: int) -> Path:
    """Runs a policy for so many steps, beyond success too."""
    actions, rows, free, success = [], [observation["observation"]], [], False
    for t in range(steps):
        actions.append(act(observation, t))
        observation, _, terminated, _, _ = env.step(actions[-1])
        rows.append(observation["observation"])
        free.append(not getattr(env, "touched", False))
        success = success or bool(terminated)
    return Path(np.array(actions), np.array(rows, float), np.array(free), success)


def ours_of(task: str, seed: int, act: Act, steps: int) -> Path:
    """A path of the native environment."""
    env = ArmEnv(f"Panda{task}")
    return recorded(env, env.reset(seed=seed)[0], act, steps)


def _steps(task: str) -> int:
    return 100 if task == "Stack" else 50


def expert(task: str, seed: int) -> Act:
    """Our scripted expert."""
    policy = Expert(f"Panda{task}-v3")
    return lambda observation, t: policy(observation)


def random(task: str, seed: int) -> Act:
    """The same uniform actions wherever it acts."""
    size = 3 if task in ("Reach", "Push", "Slide") else 4
    actions = np.random.default_rng([seed, len(task)]).uniform(-1, 1, (_steps(task), size))
    return lambda observation, t: actions[t]


def grasp(task: str, seed: int) -> Act:
    """Hovers above the cube, goes down, closes the gripper, carries."""

    def act(observation: Observation, t: int) -> Array:
        hand, cube = observation["observation"][:3], observation["observation"][7:10]
        if t < 20:
            return np.append(np.clip(10 * (cube - hand + [0, 0, 0.06 if t < 12 else 0]), -1, 1), 1.0)
        move = np.zeros(3) if t < 24 else 10 * (observation["desired_goal"] - cube)
        return np.append(np.clip(move, -1, 1), -1.0)

    return act


def shove(task: str, seed: int) -> Act:
    """Comes down behind the object, away from the goal, and moves it that way: the cube to its goal, the puck by a blow
    that ends when it has gone 4 cm."""
    start, way, hit = np.zeros(3), np.zeros(3), False
    back, low = (0.06 if task == "Push" else 0.07), 0.03

    def act(observation: Observation, t: int) -> Array:
        nonlocal start, way, hit
        hand, thing, goal = observation["observation"][:3], observation["observation"][6:9], observation["desired_goal"]
        if t == 0:
            start, way = thing.astype(float), np.append(goal[:2] - thing[:2], 0.0)
            way /= np.linalg.norm(way)
        if t < 20:
            move = 10 * ([*(start - back * way)[:2], 0.10 if t < 10 else low] - hand)
            move[2] = max(move[2], -0.4)
            return np.clip(move, -1, 1)
        left = (goal - thing)[:2]
        hit = hit or (task == "Slide" and float(np.linalg.norm((thing - start)[:2])) > 0.04)
        if hit:
            return np.zeros(3)
        speed = 0.45 if task == "Slide" else min(10 * float(np.linalg.norm(left)), 0.4) * float(left @ way[:2] > 0.01)
        return np.clip(speed * way + [0, 0, 10 * (low - hand[2])], -1, 1)

    return act


@dataclass(frozen=True)
class Replay:
    """Actions that are recorded in panda-gym, and how near our end effector and object are to stay, in the median."""

    name: str
    task: str
    policy: Callable[[str, int], Act]
    geared: bool = False
    wanted_free: float | None = None  # [m] of the hand, until the arm touches something
    wanted_hand: float | None = None  # [m]
    wanted_object: float | None = None  # [m]


REPLAYS = (
    Replay("random moves", "Reach", random, wanted_free=0.002),
    Replay("expert", "Reach", expert, wanted_hand=0.002),
    Replay(
        "grasp and carry, fingers geared", "PickAndPlace", grasp, geared=True, wanted_hand=0.002, wanted_object=0.003
    ),
    Replay("grasp and carry", "PickAndPlace", grasp, wanted_hand=0.002),
    Replay("push", "Push", shove, wanted_hand=0.002, wanted_object=0.015),
    Replay("slide", "Slide", shove, wanted_hand=0.002, wanted_object=0.04),
)


@dataclass
class Offsets:
    """Medians over all steps, and over episodes [m]."""

    free: float  # of the end effector until the arm touches something
    hand: float
    object: float | None


def replay(case: Replay, seeds: Sequence[int]) -> Offsets:
    """How far ours is from theirs under the actions recorded there."""
    hands, free_hands, objects = [], [], []
    for seed in seeds:
        with panda_gym(case.task, case.geared) as env:
            theirs = recorded(env, reset(env, case.task, seed), case.policy(case.task, seed), _steps(case.task))
        ours = ours_of(case.task, seed, lambda _, t, path=theirs: path.actions[t], _steps(case.task))
        hands.append(np.linalg.norm((ours.rows - theirs.rows)[1:, :3], axis=1))
        free_hands.append(hands[-1][theirs.free])
        if case.task in OBJECT:
            objects.append(np.linalg.norm(ours.object_end(case.task) - theirs.object_end(case.task)))
    object_end = float(np.median(objects)) if objects else None
    return Offsets(float(np.median(np.concatenate(free_hands))), float(np.median(hands)), object_end)


@dataclass
class Rates:
    theirs: float
    ours: float


def success_rates(task: str, policy: Callable[[str, int], Act], seeds: Sequence[int]) -> Rates:
    """How many episodes end well when the policy acts here, and there."""
    theirs, ours = 0, 0
    for seed in seeds:
        with panda_gym(task) as env:
            theirs += recorded(env, reset(env, task, seed), policy(task, seed), _steps(task)).success
        ours += ours_of(task, seed, policy(task, seed), _steps(task)).success
    return Rates(theirs / len(seeds), ours / len(seeds))


def _millimetres(value: float | None, wanted: float | None) -> str:
    if value is None:
        return f"{'':>16}"
    mark = "" if wanted is None else f" {'≤' if value <= wanted else '>'} {1000 * wanted:g}"
    return f"{1000 * value:>8.2f}{mark:<8}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints both tables; returns the exit status: 1 if something wanted is missed."""
    parser = argparse.ArgumentParser("python -m benchmarks.beside_panda_gym", description=__doc__)
    parser.add_argument("--seeds", type=int, default=60, help="episodes of a replay (default: %(default)s)")
    parser.add_argument("--episodes", type=int, default=200, help="of a success rate (default: %(default)s)")
    options = parser.parse_args(arguments)
    good = True
    print(f"The same actions, {options.seeds} seeds: medians [mm]")
    print(f"{'':<46}{'hand, free':>10}{'hand':>14}{'object at the end':>23}")
    for case in REPLAYS:
        found = replay(case, range(options.seeds))
        columns = (
            (found.free, case.wanted_free),
            (found.hand, case.wanted_hand),
            (found.object, case.wanted_object),
        )
        good = good and all(value is None or wanted is None or value <= wanted for value, wanted in columns)
        print(f"{case.task + ': ' + case.name:<46}{''.join(_millimetres(*column) for column in columns)}", flush=True)
    print(f"\nThe same policies, {options.episodes} seeds: success [%]")
    print(f"{'':<46}{'panda-gym':>10}{'manyhands':>10}")
    for task in TASKS:
        for name, policy in (("random", random), ("expert", expert)):
            rates = success_rates(task, policy, range(options.episodes))
            near = abs(rates.ours - rates.theirs) <= WANTED_RATE
            good = good and near
            figures = f"{100 * rates.theirs:>10.1f}{100 * rates.ours:>10.1f}{'' if near else '  apart'}"
            print(f"{task + ': ' + name:<46}{figures}", flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
