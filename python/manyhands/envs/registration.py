"""Makes the environments known to gymnasium."""

from typing import Any

import gymnasium

from manyhands._core.envs import env_ids, max_episode_steps
from manyhands.env_names import variant_of
from manyhands.envs.vector import ArmVectorEnv


def register() -> None:
    """Registers all ids, for `gymnasium.make` and `gymnasium.make_vec`; the keyword arguments override the variant."""
    for name in env_ids():
        gymnasium.register(
            id=name,
            entry_point="manyhands.envs:ArmEnv",
            vector_entry_point="manyhands.envs:ArmVectorEnv",
            max_episode_steps=max_episode_steps(name),
            kwargs=variant_of(name),
        )


def make_vector_env(name: str, num_envs: int, **kwargs: Any) -> ArmVectorEnv:
    """The vector environment of a registered id, whatever other package has registered the same id since."""
    return ArmVectorEnv(num_envs, **variant_of(name), **kwargs)
