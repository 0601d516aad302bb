"""Stable-Baselines3 on the native batch: `make_sb3("PandaPush-v3", num_envs=16, seed=0)`.

Not imported by `manyhands`, which does without Stable-Baselines3.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NoReturn, TypeAlias

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from manyhands.envs.registration import make_vector_env
from manyhands.envs.spaces import Observation
from manyhands.extras import pip_install

try:
    from stable_baselines3.common.vec_env import (  # pyright: ignore[reportMissingImports]
        VecEnv,
        VecMonitor,
    )
except ImportError as error:
    hint = pip_install("stable-baselines3")
    raise ImportError(f"manyhands.envs.sb3 needs Stable-Baselines3: {hint}") from error

Indices: TypeAlias = int | Iterable[int] | None
_OF_ONE_WORLD = {"observation_space": "single_observation_space", "action_space": "single_action_space"}


def make_sb3(env_id: str, num_envs: int = 1, seed: int | None = None, **options: Any) -> VecMonitor:
    """`num_envs` worlds for a model of Stable-Baselines3, with the records of episodes that its logs show.

    `seed` s seeds world i with s + i at the first reset. `options` are those of `gymnasium.make_vec` but
    `autoreset_mode` and `copy`. Raises ValueError on an unknown id or an option out of range.
    """
    env = SB3VecEnv(env_id, num_envs, **options)
    if seed is not None:
        env.seed(seed)
    return VecMonitor(env)


class SB3VecEnv(VecEnv):
    """What Stable-Baselines3's DummyVecEnv gives over as many `gymnasium.make(env_id)`, to the bit, but fast.

    An info holds `is_success` and `TimeLimit.truncated`, and of a world whose episode ended, `terminal_observation`.
    Worlds share their attributes and methods; `env_method("compute_reward", ...)` takes rows of goals, as
    HerReplayBuffer asks.
    """

    def __init__(self, env_id: str, num_envs: int = 1, **options: Any) -> None:
        """`options` are those of `gymnasium.make_vec` but `autoreset_mode` and `copy`.

        Raises ValueError on an unknown id or an option out of range.
        """
        self.envs = make_vector_env(env_id, num_envs, autoreset_mode=AutoresetMode.SAME_STEP, copy=True, **options)
        self._actions: Any = None
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    def reset(self) -> Observation:
        """Starts episodes in all worlds, with the seeds of `seed` if it was called since the last reset."""
        observation, info = self.envs.reset(seed=self._seeds)
        self.reset_infos = _rows(info, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        return observation

    def step_async(self, actions: NDArray[Any]) -> None:
        """Takes the actions (num_envs, action_dim) of the next `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[Observation, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Steps all worlds; those that end start anew. Returns (observation, reward, done, infos).

        Raises ValueError on actions of a wrong shape or a NaN.
        """
        observation, reward, terminated, truncated, info = self.envs.step(self._actions)
        ends = info.pop("final_obs", None)
        last = info.pop("final_info", {})
        infos = _rows(info, self.num_envs)
        done = terminated | truncated
        if ends is not None:
            last_infos = _rows(last, self.num_envs)
            for i in np.flatnonzero(done).tolist():
                self.reset_infos[i] = infos[i]
                infos[i] = {**last_infos[i], "terminal_observation": ends[i]}
        for row, timed_out in zip(infos, (truncated & ~terminated).tolist(), strict=True):
            row["TimeLimit.truncated"] = timed_out
        return observation, reward.astype(np.float32), done, infos

    def close(self) -> None:
        """Closes the worlds."""
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """The attribute, once for each index; spaces are those of one world."""
        value = getattr(self.envs, _OF_ONE_WORLD.get(attr_name, attr_name))
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Sets the attribute of all worlds. Raises ValueError if `indices` leaves one out."""
        if set(self._get_indices(indices)) != set(range(self.num_envs)):
            raise ValueError(f"set_attr: the worlds share {attr_name!r}, it cannot be set in some of them only")
        setattr(self.envs, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Indices = None, **kwargs: Any) -> list[Any]:
        """What the method returns, once for each index. Raises ValueError on `reset` and `step`."""
        if method_name in ("reset", "step"):
            _refuse(method_name)
        method = getattr(self.envs, method_name)
        return [method(*args, **kwargs) for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Indices = None) -> list[bool]:
        """False for each index: there are no wrappers around single worlds."""
        return [False for _ in self._get_indices(indices)]


def _refuse(method_name: str) -> NoReturn:
    raise ValueError(f"env_method: the worlds {method_name} together, call {method_name} of the SB3VecEnv")


def _rows(info: dict[str, Any], num_envs: int) -> list[dict[str, Any]]:
    """Gymnasium's dict of columns as a dict for each world; of two columns that differ in a leading underscore, that
    which has it (num_envs,) says which worlds have the other."""
    rows: list[dict[str, Any]] = [{} for _ in range(num_envs)]
    for key, column in info.items():
        if key.startswith("_"):
            continue
        values: Sequence[Any] = _rows(column, num_envs) if isinstance(column, dict) else _items(column)
        for i in np.flatnonzero(info[f"_{key}"]).tolist():
            rows[i][key] = values[i]
    return rows


def _items(column: NDArray[Any]) -> Sequence[Any]:
    return column.tolist() if column.ndim == 1 else list(column)
