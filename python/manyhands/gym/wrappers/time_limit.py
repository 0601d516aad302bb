"""Episodes of a limited length."""

from typing import Any

from gymnasium.error import ResetNeeded

from manyhands.gym.core import Wrapper


class TimeLimit(Wrapper):
    """Episodes end after so many steps; `done` stays True until the next reset."""

    def __init__(self, env: Any, max_episode_steps: int | None = None) -> None:
        """max_episode_steps: that of the environment's spec unless given."""
        super().__init__(env)
        self._max_episode_steps = max_episode_steps if max_episode_steps is not None else env.spec.max_episode_steps
        self._elapsed_steps: int | None = None

    def reset(self, **kwargs: Any) -> Any:
        """Starts an episode and gives its first observation."""
        self._elapsed_steps = 0
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> Any:
        """(observation, reward, done, info), or with `terminated` and `truncated` if the environment gives both.

        Raises gymnasium.error.ResetNeeded before the first reset.
        """
        if self._elapsed_steps is None:
            raise ResetNeeded("call reset before step")
        observation, reward, *ends, info = self.env.step(action)
        self._elapsed_steps += 1
        if self._elapsed_steps >= self._max_episode_steps:
            info["TimeLimit.truncated"] = not ends[0]
            ends[-1] = True
        return observation, reward, *ends, info
