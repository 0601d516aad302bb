"""The old gym with panda-gym 2 in it: `import manyhands.panda_gym.gym as gym`, then `gym.make("PandaReach-v2")`."""

from typing import Any

import gymnasium

from manyhands import gym
from manyhands.gym import Env, GoalEnv, Wrapper, envs, error, register, spaces, spec, utils, wrappers
from manyhands.panda_gym import registration

__all__ = [
    "Env", "GoalEnv", "TimeLimit", "Wrapper", "envs", "error", "make", "register", "spaces", "spec", "utils",
    "wrappers",
]  # fmt: skip


class TimeLimit(wrappers.TimeLimit):
    """An environment of panda-gym 2 whose episodes end after so many steps.

    A saved state holds the steps of its episode, so that looking ahead takes none from it; the old gym's limit counted
    those too.
    """

    def __init__(self, env: Any, max_episode_steps: int | None = None) -> None:
        super().__init__(env, max_episode_steps)
        self._saved_steps: dict[int, int | None] = {}

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


def make(id: str, **kwargs: Any) -> Any:
    """An environment of panda-gym 2 ("PandaReach-v2"; render=True keeps real time); other ids go to gymnasium.make.

    Raises gymnasium.error.NameNotFound on a name in -v2 that there is not.
    """
    if not id.endswith("-v2"):
        return gymnasium.make(id, **kwargs)
    if id not in envs.registry:
        raise error.NameNotFound(
            f"there is no environment {id!r}; there are {', '.join(registration.VARIANTS)}, each -v2"
        )
    return gym.make(id, **kwargs)


def make_version_2(**kwargs: Any) -> TimeLimit:
    """What ids in -v2 stand for in the old gym. The arguments are those of the task's environment, and `task`."""
    env = registration.make_env(**{"render": False, **kwargs})
    return TimeLimit(env, registration.max_episode_steps(kwargs["task"]))
