"""Scripted policies that solve the tasks."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import make_env_batch, make_expert
from manyhands.env_names import versioned


class Expert:
    """The scripted policy of an environment with end-effector control, for demonstrations and comparisons.

    `Expert("PandaPush-v3")(observation)` is the next action for what `reset` or `step` observed, in one environment or
    in a vector of them, here or in panda-gym. It may remember what it did before: use one for each environment.
    """

    def __init__(self, env_id: str) -> None:
        """An id, with or without its version. Raises ValueError on one without an expert; the message lists the ids."""
        self._id = versioned(env_id)
        if "Joints" in self._id:
            raise ValueError(
                f"the expert of {self._id} must know the joints, which are not observed: train with it, or use "
                f"that of {self._id.replace('Joints', '')}"
            )
        self._expert = make_expert(self._id)

    def __call__(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """(action_dim,) for a single observation, (num_envs, action_dim) for those of a vector environment.

        Raises ValueError on what is no observation of the task."""
        if not isinstance(observation, Mapping) or not {"observation", "desired_goal"} <= observation.keys():
            raise ValueError(f"{self._expected()}, not {_shown(observation)}")
        rows, goals = (np.ascontiguousarray(observation[key], np.float32) for key in ("observation", "desired_goal"))
        actions = self._expert.act(np.atleast_2d(rows), np.atleast_2d(goals))
        return actions if rows.ndim == 2 else actions[0]

    def _expected(self) -> str:
        spec = make_env_batch(self._id, 1).spec
        return (
            f"{spec.id}: the expert expects what reset and step observe, a dict with 'observation' "
            f"({spec.observation_dim},) and 'desired_goal' ({spec.goal_dim},), or with a first axis for the worlds"
        )


def _shown(observation: object) -> str:
    if isinstance(observation, Mapping):
        return f"a dict with {', '.join(map(repr, observation)) or 'nothing'}"
    return f"{type(observation).__name__} of shape {np.asarray(observation).shape}"
