"""Small wrappers of actions, observations and rewards."""

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from manyhands.gym.core import ActionWrapper, ObservationWrapper, RewardWrapper, Wrapper


class ClipAction(ActionWrapper):
    """Actions are clipped to the bounds of the action space."""

    def action(self, action: Any) -> Any:
        return np.clip(action, self.action_space.low, self.action_space.high)


class RescaleAction(ActionWrapper):
    """Actions from `a` to `b` are stretched to the bounds of the environment's action space."""

    def __init__(self, env: Any, a: ArrayLike, b: ArrayLike) -> None:
        super().__init__(env)
        self._inner = env.action_space
        shape, dtype = self._inner.shape, self._inner.dtype
        self.a, self.b = (np.full(shape, bound, dtype) for bound in (a, b))
        self.action_space = spaces.Box(self.a, self.b, shape, dtype)

    def action(self, action: Any) -> Any:
        low, high = self._inner.low, self._inner.high
        return np.clip(low + (high - low) * (action - self.a) / (self.b - self.a), low, high)


class TransformObservation(ObservationWrapper):
    """Observations pass through a function."""

    def __init__(self, env: Any, f: Callable[[Any], Any]) -> None:
        super().__init__(env)
        self.f = f

    def observation(self, observation: Any) -> Any:
        return self.f(observation)


class FlattenObservation(ObservationWrapper):
    """Observations become one row of numbers."""

    def __init__(self, env: Any) -> None:
        super().__init__(env)
        self._inner = env.observation_space
        self.observation_space = spaces.flatten_space(self._inner)

    def observation(self, observation: Any) -> Any:
        return spaces.flatten(self._inner, observation)


class FilterObservation(ObservationWrapper):
    """Of observations that are dicts, only some keys are seen: all unless given."""

    def __init__(self, env: Any, filter_keys: Sequence[str] | None = None) -> None:
        super().__init__(env)
        inner = env.observation_space.spaces
        self._keys = list(inner if filter_keys is None else filter_keys)
        if unknown := set(self._keys) - set(inner):
            raise ValueError(f"the observation has no {sorted(unknown)}; it has {sorted(inner)}")
        self.observation_space = spaces.Dict({key: inner[key] for key in self._keys})

    def observation(self, observation: Any) -> Any:
        return {key: observation[key] for key in self._keys}


class TransformReward(RewardWrapper):
    """Rewards pass through a function."""

    def __init__(self, env: Any, f: Callable[[Any], Any]) -> None:
        super().__init__(env)
        self.f = f

    def reward(self, reward: Any) -> Any:
        return self.f(reward)


class RecordEpisodeStatistics(Wrapper):
    """At the end of an episode `info["episode"]` has its return `r`, its length `l` and the seconds `t` so far."""

    def __init__(self, env: Any) -> None:
        super().__init__(env)
        self._start = time.perf_counter()
        self._return, self._length = 0.0, 0

    def reset(self, **kwargs: Any) -> Any:
        self._return, self._length = 0.0, 0
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> Any:
        observation, reward, *ends, info = self.env.step(action)
        self._return += float(reward)
        self._length += 1
        if any(ends):
            seconds = round(time.perf_counter() - self._start, 6)
            info = {**info, "episode": {"r": self._return, "l": self._length, "t": seconds}}
        return observation, reward, *ends, info
