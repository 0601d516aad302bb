"""An environment of pybullet_envs under random actions."""

from importlib import import_module
from typing import Any

import numpy as np

STEPS = 50


def drive(name: str) -> dict[str, Any]:
    """Makes it by its id, resets it and steps; what came of that."""
    import_module("pybullet_envs")  # registers them
    env: Any = import_module("gym").make(name)
    env.seed(0)
    env.action_space.seed(0)
    seen = [np.asarray(env.reset(), dtype=float)]
    rewards: list[float] = []
    for _ in range(STEPS):
        observation, reward, done, _ = env.step(env.action_space.sample())
        rewards.append(float(reward))
        seen.append(np.asarray(observation, dtype=float))
        if done:
            seen.append(np.asarray(env.reset(), dtype=float))
    finite = bool(np.isfinite(rewards).all() and all(np.isfinite(one).all() for one in seen))
    told = {
        "finite": finite,
        "reward": float(np.sum(rewards)),
        "largest": max(float(np.abs(one).max()) for one in seen),
    }
    env.close()
    return told
