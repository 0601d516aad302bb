"""What a demonstration is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import EnvSpec

ROWS = ("observation", "achieved_goal", "desired_goal")


@dataclass(frozen=True)
class Episode:
    """An episode of T steps. It terminated, at its goal, or else was truncated by the step limit."""

    seed: int
    observations: dict[str, NDArray[np.generic]]
    """(T + 1, ...) each: `ROWS`, and the pictures of cameras. Row t is what was seen before step t."""
    actions: NDArray[np.float32]
    """(T, action_dim), as they were done."""
    intended: NDArray[np.float32]
    """(T, action_dim), as the policy wanted them, before noise."""
    rewards: NDArray[np.float64]
    """(T)"""
    success: NDArray[np.bool_]
    """(T), whether the goal was reached after the step."""
    terminated: bool

    def __len__(self) -> int:
        return len(self.actions)

    @property
    def succeeded(self) -> bool:
        """At its end."""
        return bool(self.success[-1])


@dataclass(frozen=True)
class Source:
    """Where episodes come from."""

    env_id: str
    env_spec: str
    """Gymnasium's, as JSON, from which the environment can be made again."""
    spec: EnvSpec
    policy: str
    """Who acted: "expert", or the name of a policy's file."""
    noise: float
    """Standard deviation of what was added to actions."""
    seed: int
    """Of the first episode."""
    cameras: dict[str, tuple[int, int]]
    """Height and width of the pictures [pixels], by camera."""


@dataclass(frozen=True)
class Demonstrations:
    """What is learned from: N steps of all episodes, one after the other."""

    env_id: str | None
    observation: NDArray[np.float32]
    """(N, observation_dim), and the goals likewise, before each step."""
    achieved_goal: NDArray[np.float32]
    desired_goal: NDArray[np.float32]
    action: NDArray[np.float32]
    """(N, action_dim), as they were intended."""
    lengths: NDArray[np.int64]
    """(episodes), steps of each."""

    def checked(self, path: object, spec: EnvSpec) -> "Demonstrations":
        """Itself. Raises ValueError unless it fits the environment and holds numbers; `path` is for the message."""
        steps = int(self.lengths.sum()) if (self.lengths > 0).all() else 0
        if steps == 0:
            raise ValueError(f"{path} holds an episode without steps, or no episodes at all")
        goal = spec.goal_dim
        expected = {
            "observation": spec.observation_dim,
            "achieved_goal": goal,
            "desired_goal": goal,
            "action": spec.action_dim,
        }
        for name, size in expected.items():
            values = getattr(self, name)
            if values.shape != (steps, size):
                raise ValueError(
                    f"{path} does not fit {spec.id}: its {name} has shape {values.shape}, expected {(steps, size)}"
                )
            if not np.isfinite(values).all():
                raise ValueError(f"{path}: its {name} holds what is no finite number")
        return self
