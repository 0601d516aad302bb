"""Makes the environments known to gymnasium."""

import re

import gymnasium

from manyhands._core.envs import env_ids

_ID = re.compile(r"(Panda\w+?)(Joints)?(Dense)?-v3")
_MAX_EPISODE_STEPS = 50


def register() -> None:
    """Registers all ids, for `gymnasium.make` and `gymnasium.make_vec`; the keyword arguments override the variant."""
    for name in env_ids():
        match = _ID.fullmatch(name)
        assert match is not None, f"{name} is not of the form Panda<Task>[Joints][Dense]-v3"
        task, joints, dense = match.groups()
        gymnasium.register(
            id=name,
            entry_point="manyhands.envs:PandaEnv",
            vector_entry_point="manyhands.envs:PandaVectorEnv",
            max_episode_steps=_MAX_EPISODE_STEPS,
            kwargs={
                "task": task,
                "reward_type": "dense" if dense else "sparse",
                "control_type": "joints" if joints else "ee",
            },
        )
