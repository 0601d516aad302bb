"""Makes the environments known to gymnasium."""

import re
from typing import Any

import gymnasium

from manyhands._core.envs import env_ids, max_episode_steps
from manyhands.envs.vector import PandaVectorEnv

_ID = re.compile(r"(Panda\w+?)(Joints)?(Dense)?-v3")


def register() -> None:
    """Registers all ids, for `gymnasium.make` and `gymnasium.make_vec`; the keyword arguments override the variant."""
    for name in env_ids():
        gymnasium.register(
            id=name,
            entry_point="manyhands.envs:PandaEnv",
            vector_entry_point="manyhands.envs:PandaVectorEnv",
            max_episode_steps=max_episode_steps(name),
            kwargs=variant_of(name),
        )


def make_vector_env(name: str, num_envs: int, **kwargs: Any) -> PandaVectorEnv:
    """The vector environment of a registered id, whatever other package has registered the same id since."""
    return PandaVectorEnv(num_envs, **variant_of(name), **kwargs)


def variant_of(name: str) -> dict[str, Any]:
    """What an id stands for, as arguments of `PandaEnv`. Raises ValueError on an id of another form."""
    match = _ID.fullmatch(name)
    if match is None:
        raise ValueError(f"{name!r} is not of the form Panda<Task>[Joints][Dense]-v3")
    task, joints, dense = match.groups()
    return {
        "task": task,
        "reward_type": "dense" if dense else "sparse",
        "control_type": "joints" if joints else "ee",
    }
