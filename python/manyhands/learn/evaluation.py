"""What a trained policy reaches."""

from collections.abc import Iterator
from typing import Any, Literal, overload

import gymnasium
import numpy as np

from manyhands.arguments import whole_number
from manyhands.learn.layout import ObservationLayout
from manyhands.learn.model import Model
from manyhands.learn.returned import checked_rows, checked_step, first_observation, require_seed
from manyhands.learn.worlds import checked_name


@overload
def evaluate_policy(
    model: Model,
    env: Any,
    n_eval_episodes: int = 10,
    deterministic: bool = True,
    seed: int = 0,
    *,
    return_episode_rewards: Literal[False] = False,
) -> tuple[float, float]: ...


@overload
def evaluate_policy(
    model: Model,
    env: Any,
    n_eval_episodes: int = 10,
    deterministic: bool = True,
    seed: int = 0,
    *,
    return_episode_rewards: Literal[True],
) -> tuple[list[float], list[int]]: ...


def evaluate_policy(
    model: Model,
    env: Any,
    n_eval_episodes: int = 10,
    deterministic: bool = True,
    seed: int = 0,
    *,
    return_episode_rewards: bool = False,
) -> tuple[float, float] | tuple[list[float], list[int]]:
    """Mean and standard deviation of the return over episodes of one Gymnasium environment, from seed `seed` on; with
    `return_episode_rewards` the return of each episode and its steps.

    Raises TypeError on anything else than an environment, ValueError on one that is not as Gymnasium wants it.
    """
    whole_number("n_eval_episodes", n_eval_episodes, 1, 2**31)
    if not isinstance(env, gymnasium.Env):
        raise TypeError(f"env is {env!r}, expected one Gymnasium environment, as gymnasium.make gives it")
    name = checked_name(env)
    require_seed(env.unwrapped, name)
    seeds = range(seed, seed + n_eval_episodes)
    episodes = [list(_rewards(model, env, name, each, deterministic)) for each in seeds]
    returns = [sum(rewards) for rewards in episodes]
    if return_episode_rewards:
        return returns, [len(rewards) for rewards in episodes]
    return float(np.mean(returns)), float(np.std(returns))


def _rewards(model: Model, env: gymnasium.Env[Any, Any], name: str, seed: int, deterministic: bool) -> Iterator[float]:
    """Of one episode."""
    layout = ObservationLayout(env.observation_space)
    observation, over = first_observation(env.reset(seed=seed), name), False
    checked_rows(layout, [observation], f"{name}.reset()")
    while not over:
        action, _ = model.predict(observation, deterministic=deterministic)
        observation, reward, terminated, truncated, _ = checked_step(env.step(action), name)
        checked_rows(layout, [observation], f"{name}.step()")
        yield reward
        over = terminated or truncated
