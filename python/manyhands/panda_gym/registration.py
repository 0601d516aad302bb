"""The names of the environments, and what gymnasium makes of them."""

from typing import Any

import gymnasium

from manyhands import gym
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


def make_version_2(*, render: bool = False, **kwargs: Any) -> RobotTaskEnv:
    """The environment of an id in -v2 with Gymnasium's returns: as in version 2, episodes go on after success."""
    mode = "human" if render else "rgb_array"
    return make_env(**{"render_mode": mode, "terminate_on_success": False, **kwargs})


def register() -> list[str]:
    """Makes gymnasium's `make` give these environments for all ids, and returns those in -v3; `make_vec` gives those
    that are stepped in C++, as before. The old gym gives version 2 for the ids in -v2."""
    for name, variant in VARIANTS.items():
        limit = max_episode_steps(variant["task"])
        _register(f"{name}-v3", "make_env", limit, variant)
        _register(f"{name}-v2", "make_version_2", limit, variant)
        old_id = f"{name}-v2"
        gym.envs.registry.pop(old_id, None)
        gym.register(
            old_id, entry_point="manyhands.panda_gym.gym:make_version_2", max_episode_steps=limit, kwargs=variant
        )
    return [f"{name}-v3" for name in VARIANTS]


def _register(name: str, maker: str, limit: int, variant: dict[str, Any]) -> None:
    gymnasium.registry.pop(name, None)
    gymnasium.register(
        id=name,
        entry_point=f"manyhands.panda_gym.registration:{maker}",
        vector_entry_point="manyhands.envs:ArmVectorEnv",
        max_episode_steps=limit,
        kwargs=variant,
    )
