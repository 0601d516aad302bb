"""As much of the old gym as panda-gym 2 needs: `import manyhands.panda_gym.gym as gym`, then `gym.make(...)`."""

from typing import Any

import gymnasium
from gymnasium import spaces
from gymnasium.error import NameNotFound, ResetNeeded

from manyhands.panda_gym import registration
from manyhands.panda_gym.envs.core import RobotTaskEnv

__all__ = ["TimeLimit", "make", "spaces"]


class TimeLimit:
    """An environment of panda-gym 2 whose episodes end after so many steps; what else is asked of it, it answers.

    `done` stays True until the next reset. A saved state holds the steps of its episode, so that looking ahead takes
    none from it; the old gym's limit counted those too.
    """

    def __init__(self, env: RobotTaskEnv, max_episode_steps: int) -> None:
        self.env = env
        self._max_episode_steps = max_episode_steps
        self._elapsed_steps: int | None = None
        self._saved_steps: dict[int, int | None] = {}

    @property
    def unwrapped(self) -> RobotTaskEnv:
        """The environment itself."""
        return self.env

    def __getattr__(self, name: str) -> Any:
        if name == "env":  # while it is being copied
            raise AttributeError(name)
        return getattr(self.env, name)

    def reset(self, **kwargs: Any) -> Any:
        """Starts an episode and gives its first observation."""
        self._elapsed_steps = 0
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> tuple[Any, float, bool, dict[str, Any]]:
        """(observation, reward, done, info). Raises gymnasium.error.ResetNeeded before the first reset."""
        if self._elapsed_steps is None:
            raise ResetNeeded("call reset before step")
        observation, reward, done, info = self.env.step(action)
        self._elapsed_steps += 1
        if self._elapsed_steps >= self._max_episode_steps:
            info["TimeLimit.truncated"] = not done
            done = True
        return observation, reward, done, info

    def save_state(self) -> int:
        """Keeps the present state, until `remove_state` of the number that this returns."""
        state_id = self.env.save_state()
        self._saved_steps[state_id] = self._elapsed_steps
        return state_id

    def restore_state(self, state_id: int) -> None:
        """Goes back to a saved state and to the step it was saved after."""
        self.env.restore_state(state_id)
        self._elapsed_steps = self._saved_steps.get(state_id, self._elapsed_steps)

    def remove_state(self, state_id: int) -> None:
        """Forgets a saved state."""
        self.env.remove_state(state_id)
        self._saved_steps.pop(state_id, None)

    def render(self, mode: str = "human", **kwargs: Any) -> Any:
        """As `RobotTaskEnv.render`."""
        return self.env.render(mode, **kwargs)

    def close(self) -> None:
        """Ends the simulation; may be called again."""
        self.env.close()

    def __repr__(self) -> str:
        return f"<TimeLimit {self._max_episode_steps} of {self.env!r}>"


def make(id: str, **kwargs: Any) -> Any:
    """An environment of panda-gym 2 ("PandaReach-v2"; render=True keeps real time); other ids go to gymnasium.make.

    Raises gymnasium.error.NameNotFound on a name in -v2 that there is not.
    """
    if not id.endswith("-v2"):
        return gymnasium.make(id, **kwargs)
    variant = registration.VARIANTS.get(id.removesuffix("-v2"))
    if variant is None:
        raise NameNotFound(f"there is no environment {id!r}; there are {', '.join(registration.VARIANTS)}, each -v2")
    env = registration.make_env(**{**variant, "render": False, **kwargs})
    return TimeLimit(env, registration.max_episode_steps(variant["task"]))
