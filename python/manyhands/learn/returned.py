"""What the methods of a user's environment return: taken apart, or refused in a line that says what was expected."""

import inspect
from collections.abc import Mapping
from reprlib import repr as short
from typing import Any

import numpy as np

_STEP = "(observation, reward, terminated, truncated, info)"


def brief(value: Any) -> str:
    """A value in a few words: an array by its shape."""
    if isinstance(value, np.ndarray) and value.size > 4:
        return f"an array of shape {value.shape}"
    return " ".join(short(value).split())


def require_seed(env: Any, name: str) -> None:
    """Raises ValueError unless `env.reset(seed=...)` can be called."""
    try:
        inspect.signature(env.reset).bind(seed=0)
    except TypeError:
        signature = "def reset(self, *, seed=None, options=None)"
        raise ValueError(f"{name}.reset() takes no seed, expected {signature}") from None


def first_observation(result: Any, name: str) -> Any:
    """Of what `reset` returned. Raises ValueError if that is no observation and info."""
    if not isinstance(result, tuple) or len(result) != 2 or not isinstance(result[1], Mapping):
        raise ValueError(f"{name}.reset() returned {brief(result)}, expected (observation, info), info being a dict")
    return result[0]


def checked_step(result: Any, name: str) -> tuple[Any, float, bool, bool, Mapping[str, Any]]:
    """What `step` returned, as plain numbers and flags. Raises ValueError on anything else."""
    if not isinstance(result, tuple) or len(result) != 5:
        what = f"{len(result)} values" if isinstance(result, tuple) else brief(result)
        raise ValueError(f"{name}.step() returned {what}, expected {_STEP}")
    observation, reward, terminated, truncated, info = result
    try:
        reward = float(reward if np.ndim(reward) == 0 else np.asarray(reward).item())
    except (TypeError, ValueError):
        raise ValueError(f"{name}.step() returned the reward {brief(reward)}, expected a number") from None
    for flag, value in {"terminated": terminated, "truncated": truncated}.items():
        if not isinstance(value, bool | np.bool_ | int) and np.shape(value) not in ((), (1,)):
            raise ValueError(f"{name}.step() returned {flag} as {brief(value)}, expected True or False")
    if not isinstance(info, Mapping):
        raise ValueError(f"{name}.step() returned the info {brief(info)}, expected a dict")
    return observation, reward, bool(terminated), bool(truncated), info
