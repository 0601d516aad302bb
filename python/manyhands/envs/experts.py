"""Scripted policies that solve the tasks."""

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import make_expert
from manyhands.envs.spaces import Observation


class Expert:
    """The scripted policy of an environment with end-effector control, for demonstrations and comparisons.

    `Expert("PandaPush-v3")(observation)` is the next action for what `reset` or `step` observed, in one environment or
    in a vector of them, here or in panda-gym. It may remember what it did before: use one for each environment.
    """

    def __init__(self, env_id: str) -> None:
        """Raises ValueError on an id without an expert; the message lists the ids."""
        self._expert = make_expert(env_id)

    def __call__(self, observation: Observation) -> NDArray[np.float32]:
        """(action_dim,) for a single observation, (num_envs, action_dim) for those of a vector environment."""
        rows, goals = (np.ascontiguousarray(observation[key], np.float32) for key in ("observation", "desired_goal"))
        actions = self._expert.act(np.atleast_2d(rows), np.atleast_2d(goals))
        return actions if rows.ndim == 2 else actions[0]
