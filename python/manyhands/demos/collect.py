"""Runs episodes in batches."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from manyhands.demos.episodes import Episode
from manyhands.envs.vector import ArmVectorEnv

Act = Callable[[Mapping[str, NDArray[Any]]], NDArray[np.float32]]
_TRIES = 20  # episodes, for each that is wanted, after which a policy is not expected to succeed any more


def collect(
    env: ArmVectorEnv, policy: Callable[[], Act], wanted: int, seed: int, noise: float = 0.0, success_only: bool = False
) -> Iterator[Episode]:
    """`wanted` episodes; the k-th that is run starts from seed + k, and is the same whatever the number of worlds.

    env: in the mode NEXT_STEP. policy: makes what acts in all worlds, anew for each round of episodes.
    noise: standard deviation of what is added to actions. success_only: failures are left out.

    Raises ValueError if the policy hardly ever succeeds where it must.
    """
    if env.metadata["autoreset_mode"] != AutoresetMode.NEXT_STEP:
        raise ValueError(f"autoreset_mode is {env.metadata['autoreset_mode']}, expected NEXT_STEP")
    found = tried = 0
    while found < wanted:
        for episode in _round(env, policy(), seed + tried, noise):
            tried += 1
            if episode.succeeded or not success_only:
                found += 1
                yield episode
            if found == wanted:
                return
            if tried >= _TRIES * wanted:
                raise ValueError(
                    f"of {tried} episodes only {found} succeeded, and {wanted} are wanted: take a better policy, less "
                    "noise, or failures too"
                )


def _round(env: ArmVectorEnv, act: Act, seed: int, noise: float) -> Iterator[Episode]:
    """One episode in each world, in the order of their seeds."""
    n = env.num_envs
    streams = [np.random.default_rng([seed + world, 1]) for world in range(n)]
    observation, _ = env.reset(seed=seed)
    seen, done = [observation], []
    lengths, terminated = np.zeros(n, np.int64), np.zeros(n, np.bool_)
    while not lengths.all():
        intended = act(observation)
        actions = intended
        if noise > 0:
            added = np.stack([stream.normal(0.0, noise, intended.shape[1]) for stream in streams])
            actions = np.clip(intended + added, -1, 1).astype(np.float32)
        observation, reward, ends_well, ends, info = env.step(actions)
        seen.append(observation)
        done.append((actions, intended, reward, info["is_success"]))
        ended = (ends_well | ends) & (lengths == 0)
        terminated[ended] = ends_well[ended]
        lengths[ended] = len(done)
    for world, length in enumerate(lengths):
        actions, intended, reward, success = (
            np.stack([values[world] for values in column[:length]]) for column in zip(*done, strict=True)
        )
        observations = {name: np.stack([rows[name][world] for rows in seen[: length + 1]]) for name in seen[0]}
        yield Episode(seed + world, observations, actions, intended, reward, success, bool(terminated[world]))
