"""How the spaces of an environment become the rows of numbers that networks see, and back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

_GOAL_KEYS = {"observation", "achieved_goal", "desired_goal"}

Rows = NDArray[np.float32]


def _is_picture(space: gymnasium.Space[Any]) -> bool:
    return isinstance(space, spaces.Box) and space.dtype == np.uint8 and len(space.shape) == 3


class ObservationLayout:
    """Observations as rows: of a goal environment observation and goals, of any other one flat observation."""

    def __init__(self, space: gymnasium.Space[Any]) -> None:
        """Raises ValueError on a space of pictures, or one that cannot be flattened."""
        self.space = space
        self._parts = dict(space.spaces) if isinstance(space, spaces.Dict) else {}
        self.has_goals = set(self._parts) == _GOAL_KEYS
        if any(_is_picture(part) for part in self._parts.values() or [space]):
            raise ValueError(f"the observations {space} hold pictures, which these policies do not see")
        if not space.is_np_flattenable:
            raise ValueError(f"the observations {space} cannot be made into a row of numbers")
        if self.has_goals:
            self.observation_dim, self.goal_dim = (
                self._dim(self._parts[key]) for key in ("observation", "desired_goal")
            )
        else:
            self.observation_dim, self.goal_dim = self._dim(space), 0

    @staticmethod
    def _dim(space: gymnasium.Space[Any]) -> int:
        return int(spaces.flatdim(space))

    def rows(self, observations: list[Any]) -> tuple[Rows, Rows, Rows]:
        """(observation, achieved_goal, desired_goal) of n observations, (n, observation_dim) and (n, goal_dim)."""
        if self.has_goals:
            parts = (
                [self._flat(self._parts[key], one[key]) for one in observations]
                for key in ("observation", "achieved_goal", "desired_goal")
            )
            observation, achieved, desired = (np.stack(part) for part in parts)
            return observation, achieved, desired
        none = np.zeros((len(observations), 0), np.float32)
        return np.stack([self._flat(self.space, one) for one in observations]), none, none

    @staticmethod
    def _flat(space: gymnasium.Space[Any], value: Any) -> Rows:
        return np.asarray(spaces.flatten(space, value), np.float32)

    def fitting_rows(self, observations: list[Any]) -> tuple[Rows, Rows, Rows] | None:
        """`rows`, or None if there is an observation that is not as the space says."""
        try:
            parts = self.rows(observations)
        except (TypeError, ValueError, LookupError, AttributeError):
            return None
        lengths = self.observation_dim, self.goal_dim, self.goal_dim
        return parts if tuple(part.shape[1] for part in parts) == lengths else None

    def unbatch(self, observation: Any) -> tuple[list[Any], bool]:
        """The observations in what may be one or an array of several, and whether it is several."""
        if self._parts:
            if not isinstance(observation, Mapping):
                raise ValueError(f"the observation is a {type(observation).__name__}, expected a dict as {self.space}")
            missing = set(self._parts) - set(observation)
            if missing:
                raise ValueError(f"the observation lacks {', '.join(sorted(missing))}")
            key, part = next(iter(self._parts.items()))
            if not self._several(part, observation[key]):
                return [observation], False
            return [{k: observation[k][i] for k in self._parts} for i in range(len(observation[key]))], True
        if not self._several(self.space, observation):
            return [observation], False
        return list(observation), True

    @staticmethod
    def _several(space: gymnasium.Space[Any], value: Any) -> bool:
        shape, own = np.shape(value), space.shape or ()
        if shape not in (own, (*shape[:1], *own)):
            raise ValueError(f"the observation has shape {shape}, expected {own} or (n, {', '.join(map(str, own))})")
        return shape != own


@dataclass(frozen=True)
class ActionLayout:
    """Actions in [-1, 1], or the index of a choice, as the environment wants them."""

    shape: tuple[int, ...]
    low: list[float]  # flat; empty for choices
    high: list[float]
    choices: int  # 0: none
    start: int = 0  # the number of the first choice
    dtype: str = "float32"

    @staticmethod
    def of(space: gymnasium.Space[Any]) -> "ActionLayout":
        """Raises ValueError on a space that no algorithm here acts in."""
        if isinstance(space, spaces.Discrete):
            return ActionLayout((), [], [], int(space.n), int(space.start), str(space.dtype))
        if isinstance(space, spaces.Box) and np.all(np.isfinite(space.low)) and np.all(np.isfinite(space.high)):
            low, high = (np.asarray(bound, float).ravel().tolist() for bound in (space.low, space.high))
            return ActionLayout(space.shape, low, high, 0, 0, str(space.dtype))
        raise ValueError(f"the actions are {space}, expected a Box with finite bounds or a Discrete space")

    @property
    def dim(self) -> int:
        """Numbers of an action row."""
        return 1 if self.choices else len(self.low)

    def actions(self, rows: Rows) -> Any:
        """What the environment takes, of rows (n, dim): an array with a first axis for the n actions."""
        if self.choices:
            return (rows[:, 0].astype(np.int64) + self.start).astype(self.dtype)
        low, high = np.asarray(self.low), np.asarray(self.high)
        values = low + (np.clip(rows, -1, 1) + 1) / 2 * (high - low)
        return values.reshape(len(rows), *self.shape).astype(self.dtype)
