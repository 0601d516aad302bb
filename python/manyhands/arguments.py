"""Checks of arguments whose messages name the argument."""

from typing import Any

import numpy as np

MOST_THREADS = 1024


def whole_number(name: str, value: Any, lowest: int, highest: int | None = None) -> int:
    """`value` as an int. Raises ValueError unless it is a whole number of `lowest` to `highest`, both included."""
    expected = f"{lowest} or more" if highest is None else f"{lowest} to {highest}"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} is {value!r}, expected a whole number of {expected}")
    if value < lowest or (highest is not None and value > highest):
        raise ValueError(f"{name} is {value}, expected {expected}")
    return int(value)
