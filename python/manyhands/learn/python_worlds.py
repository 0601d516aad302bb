"""Gymnasium environments as a batch that the trainer in C++ steps."""

from collections.abc import Sequence
from typing import Any, Protocol

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from numpy.typing import NDArray

from manyhands._core.envs import PythonBatch
from manyhands.learn.layout import ActionLayout, ObservationLayout
from manyhands.learn.returned import brief, checked_rows, checked_step, first_observation, require_seed

DEFAULT_LIMIT = 1000  # steps of an episode where the environment has no limit: what is longer is cut


class _Stepped(Protocol):
    """What differs between a list of environments and a vector."""

    num_envs: int
    task: Any  # with compute_reward, if it has goals

    def reset(self, mask: NDArray[np.bool_], seeds: NDArray[np.uint64]) -> list[Any]: ...

    def step(self, actions: Any) -> tuple[list[Any], Any, Any, Any, list[dict[str, Any]]]: ...


class _Singles:
    """Environments one by one, each reset as soon as its episode ends."""

    def __init__(self, envs: Sequence[gymnasium.Env[Any, Any]], name: str) -> None:
        """Raises ValueError if they cannot be given a seed."""
        self._envs = envs
        self._name = name
        self._last: list[Any] = [None] * len(envs)
        self.num_envs = len(envs)
        self.task = envs[0].unwrapped
        require_seed(self.task, name)

    def reset(self, mask: NDArray[np.bool_], seeds: NDArray[np.uint64]) -> list[Any]:
        for i in np.flatnonzero(mask).tolist():
            result = self._envs[i].reset(seed=int(seeds[i] % 2**31))
            self._last[i] = first_observation(result, self._name)
        return self._last

    def step(self, actions: Any) -> tuple[list[Any], Any, Any, Any, list[dict[str, Any]]]:
        results = [checked_step(env.step(action), self._name) for env, action in zip(self._envs, actions, strict=True)]
        self._last, rewards, terminated, truncated, infos = (list(part) for part in zip(*results, strict=True))
        return self._last, rewards, terminated, truncated, infos


class _Vector:
    """A vector that resets what is asked of it (DISABLED) or has done so within the step (SAME_STEP).

    The streams of its worlds go on from one seed: Gymnasium gives no other way to seed a part of them.
    """

    def __init__(self, envs: VectorEnv[Any, Any, Any], layout: ObservationLayout) -> None:
        self._envs = envs
        self._layout = layout
        self._resets_itself = envs.metadata.get("autoreset_mode") is AutoresetMode.SAME_STEP
        self._started = False
        self._next: list[Any] = []
        self.num_envs = envs.num_envs
        self.task = envs.unwrapped

    def _list(self, observations: Any) -> list[Any]:
        return self._layout.unbatch(observations)[0]

    def reset(self, mask: NDArray[np.bool_], seeds: NDArray[np.uint64]) -> list[Any]:
        if not self._started:
            self._started = True
            self._next = self._list(self._envs.reset(seed=int(seeds[0] % 2**31))[0])
        elif not self._resets_itself and mask.any():
            self._next = self._list(self._envs.reset(options={"reset_mask": mask})[0])
        return self._next

    def step(self, actions: Any) -> tuple[list[Any], Any, Any, Any, list[dict[str, Any]]]:
        observations, rewards, terminated, truncated, info = self._envs.step(actions)
        shown = self._next = self._list(observations)
        final_info = info.get("final_info", {}) if self._resets_itself else {}
        if self._resets_itself and "final_obs" in info:
            ended = info["_final_obs"]
            shown = [last if end else now for last, end, now in zip(info["final_obs"], ended, shown, strict=True)]
        success = info.get("is_success", final_info.get("is_success"))
        infos = [{} for _ in shown] if success is None else [{"is_success": bool(one)} for one in success]
        return shown, rewards, terminated, truncated, infos


class PythonWorlds:
    """The host of a `PythonBatch`: writes what environments show into the arrays that it shares with C++."""

    def __init__(self, worlds: _Stepped, observation: ObservationLayout, action: ActionLayout, name: str) -> None:
        n, no, ng = worlds.num_envs, observation.observation_dim, observation.goal_dim
        self._worlds = worlds
        self._name = name
        self._layout = observation
        self._actions = action
        self.observation = np.zeros((n, no), np.float32)
        self.achieved_goal, self.desired_goal = np.zeros((2, n, ng), np.float32)
        self.reward = np.zeros(n, np.float32)
        self.is_success, self.terminated, self.truncated = np.zeros((3, n), bool)
        self.has_success = observation.has_goals  # or once an info says so

    def batch(self, limit: int) -> PythonBatch:
        """The batch; episodes are cut after `limit` steps."""
        return PythonBatch(
            id=self._name,
            action_dim=self._actions.dim,
            choices=self._actions.choices,
            max_episode_steps=limit,
            host=self,
            observation=self.observation,
            achieved_goal=self.achieved_goal,
            desired_goal=self.desired_goal,
            reward=self.reward,
            is_success=self.is_success,
            terminated=self.terminated,
            truncated=self.truncated,
        )

    def _show(self, observations: list[Any], method: str) -> None:
        """What `method` returned. Raises ValueError unless it is as the space says."""
        parts = checked_rows(self._layout, observations, f"{self._name}.{method}")
        own = (self.observation, self.achieved_goal, self.desired_goal)
        for mine, rows in zip(own, parts, strict=True):
            mine[:] = rows

    def reset(self, mask: NDArray[np.bool_], seeds: NDArray[np.uint64]) -> None:
        """Called from C++."""
        self._show(self._worlds.reset(mask, seeds), "reset()")
        self.terminated[mask] = self.truncated[mask] = self.is_success[mask] = False

    def step(self, rows: NDArray[np.float32]) -> None:
        """Called from C++."""
        observations, reward, terminated, truncated, infos = self._worlds.step(self._actions.actions(rows))
        self._show(observations, "step()")
        self.reward[:] = reward
        if not np.isfinite(self.reward).all():
            raise ValueError(f"{self._name}.step() returned a reward that is not finite")
        self.terminated[:], self.truncated[:] = terminated, truncated
        self.is_success[:] = [bool(info.get("is_success", False)) for info in infos]
        self.has_success = self.has_success or any("is_success" in info for info in infos)

    def compute_reward(self, achieved: NDArray[np.float32], desired: NDArray[np.float32]) -> NDArray[np.float32]:
        """Called from C++, to give old transitions new goals."""
        asked = getattr(self._worlds.task, "compute_reward", None)
        if not callable(asked):
            raise ValueError(
                f"{self._name} has goals and no compute_reward(achieved_goal, desired_goal, info), which hindsight "
                "asks: write it, or set hindsight_fraction=0"
            )
        goals = f"goals of shape {achieved.shape}"
        try:
            returned = asked(achieved, desired, {})
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            raise RuntimeError(
                f"{self._name}.compute_reward() raised {reason}; it was given achieved and desired {goals} and an "
                "empty info"
            ) from error
        rewards = np.asarray(returned)
        if rewards.shape != achieved.shape[:1] or rewards.dtype.kind not in "biuf":
            raise ValueError(
                f"{self._name}.compute_reward() returned {brief(returned)} for {goals}, expected "
                f"an array of shape {achieved.shape[:1]}: a reward for each row"
            )
        return rewards.astype(np.float32)


def as_stepped(
    envs: Sequence[gymnasium.Env[Any, Any]] | VectorEnv[Any, Any, Any], layout: ObservationLayout, name: str
) -> _Stepped:
    """Raises ValueError on a vector whose way to reset does not show where episodes end."""
    if not isinstance(envs, VectorEnv):
        return _Singles(envs, name)
    if isinstance(envs, SyncVectorEnv):
        return _Singles(envs.envs, name)
    mode = envs.metadata.get("autoreset_mode")
    if mode not in (AutoresetMode.SAME_STEP, AutoresetMode.DISABLED):
        raise ValueError(
            f"the vector environment's autoreset mode is {mode}: make it with autoreset_mode=AutoresetMode.SAME_STEP"
        )
    return _Vector(envs, layout)


def episode_limit(env: gymnasium.Env[Any, Any] | VectorEnv[Any, Any, Any]) -> int:
    """The steps after which its episodes are cut."""
    spec = env.spec
    limit = None if spec is None else spec.max_episode_steps
    return DEFAULT_LIMIT if limit is None or limit <= 0 else limit
