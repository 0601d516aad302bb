"""The names of the environments, and what gymnasium makes of them."""

from typing import Any

import gymnasium

from manyhands.panda_gym import envs
from manyhands.panda_gym.envs.core import RobotTaskEnv

_TASKS = ("Reach", "Slide", "Push", "PickAndPlace", "Stack", "Flip")
_TYPES = {
    "": ("sparse", "ee"),
    "Joints": ("sparse", "joints"),
    "Dense": ("dense", "ee"),
    "JointsDense": ("dense", "joints"),
}

VARIANTS: dict[str, dict[str, Any]] = {
    f"Panda{task}{suffix}": {"task": f"Panda{task}", "reward_type": reward_type, "control_type": control_type}
    for task in _TASKS
    for suffix, (reward_type, control_type) in _TYPES.items()
}
"""All names without their version, and what they stand for."""


def max_episode_steps(task: str) -> int:
    """Of "PandaStack" 100, of the other tasks 50."""
    return 100 if task == "PandaStack" else 50


def make_env(task: str, **kwargs: Any) -> RobotTaskEnv:
    """The environment of a task, "PandaPush" for example, without any wrapper."""
    return getattr(envs, f"{task}Env")(**kwargs)


def register() -> list[str]:
    """Makes gymnasium's `make` give these environments for all ids, and returns them; `make_vec` gives those that are
    stepped in C++, as before."""
    ids = []
    for name, variant in VARIANTS.items():
        ids.append(f"{name}-v3")
        gymnasium.registry.pop(ids[-1], None)
        gymnasium.register(
            id=ids[-1],
            entry_point="manyhands.panda_gym.registration:make_env",
            vector_entry_point="manyhands.envs:ArmVectorEnv",
            max_episode_steps=max_episode_steps(variant["task"]),
            kwargs=variant,
        )
    return ids
