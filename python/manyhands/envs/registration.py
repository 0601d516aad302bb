"""Makes the environments known to gymnasium."""

from typing import Any

import gymnasium

from manyhands._core.envs import env_ids, max_episode_steps
from manyhands.env_names import VERSION, variant_of
from manyhands.envs.vector import ArmVectorEnv


def register() -> None:
    """Registers all ids, for `gymnasium.make` and `gymnasium.make_vec`; the keyword arguments override the variant.

    Those in -v2 are panda-gym's older ones: their episodes go on after success.
    """
    for name in env_ids():
        variant, limit = variant_of(name), max_episode_steps(name)
        _register(name, limit, variant)
        _register(f"{name.removesuffix(VERSION)}-v2", limit, {**variant, "terminate_on_success": False})


def _register(name: str, limit: int, variant: dict[str, Any]) -> None:
    gymnasium.register(
        id=name,
        entry_point="manyhands.envs:ArmEnv",
        vector_entry_point="manyhands.envs:ArmVectorEnv",
        max_episode_steps=limit,
        kwargs=variant,
    )


def make_vector_env(name: str, num_envs: int, **kwargs: Any) -> ArmVectorEnv:
    """The vector environment of a registered id, whatever other package has registered the same id since."""
    return ArmVectorEnv(num_envs, **variant_of(name), **kwargs)
