"""What the methods of a user's environment return: taken apart, or refused in a line that says what was expected."""

import inspect
import math
from collections.abc import Mapping
from reprlib import repr as short
from typing import Any

import numpy as np

from manyhands.learn.layout import ObservationLayout, Rows

_STEP = "(observation, reward, terminated, truncated, info)"


def brief(value: Any) -> str:
    """A value in a few words: an array by its shape and type, a dict by what it holds."""
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and dtype {value.dtype}"
    if isinstance(value, Mapping):
        return f"a dict of {', '.join(f'{key}: {brief(part)}' for key, part in value.items()) or 'nothing'}"
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
    number = _number(reward)
    if number is None:
        raise ValueError(f"{name}.step() returned {brief(reward)} as reward, expected a number")
    if not math.isfinite(number):
        raise ValueError(f"{name}.step() returned a reward that is not finite")
    for flag, value in {"terminated": terminated, "truncated": truncated}.items():
        if _number(value) not in (0, 1):
            raise ValueError(f"{name}.step() returned {brief(value)} as {flag}, expected True or False")
    if not isinstance(info, Mapping):
        raise ValueError(f"{name}.step() returned {brief(info)} as info, expected a dict")
    return observation, float(number), bool(terminated), bool(truncated), info


def _number(value: Any) -> float | None:
    """The number or flag that `value` is, or holds as the only one; None if there is none."""
    if isinstance(value, bool | int | float):
        return value
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        return None
    return array.item() if array.size == 1 and array.dtype.kind in "biuf" else None


def checked_rows(layout: ObservationLayout, observations: list[Any], method: str) -> tuple[Rows, Rows, Rows]:
    """`layout.rows`. Raises ValueError, which says what `method` returned, unless all are finite and of its space."""
    parts = layout.fitting_rows(observations)
    if parts is None:
        misfit = next(one for one in observations if layout.fitting_rows([one]) is None)
        expected = f"expected one of its observation_space, {layout.space}"
        raise ValueError(f"{method} returned {brief(misfit)} as observation, {expected}")
    if not all(np.isfinite(rows).all() for rows in parts):
        raise ValueError(f"{method} returned an observation that is not finite")
    return parts
