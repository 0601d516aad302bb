"""Makes the environments known to gymnasium."""

from typing import Any

import gymnasium

from manyhands._core.envs import env_ids, max_episode_steps
from manyhands.env_names import variant_of
from manyhands.envs.vector import PandaVectorEnv


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
