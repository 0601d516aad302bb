"""Checks of arguments whose messages name the argument."""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_THREADS = 1024
_FEW = 32  # numbers that Python looks at faster than numpy does

FloatArray = NDArray[Any]
"""float32 or float64, as the input."""


def float_arrays(**inputs: ArrayLike) -> list[FloatArray]:
    """The inputs as C-contiguous arrays of one type: float32 if all are, else float64."""
    arrays = [_real(name, values) for name, values in inputs.items()]
    single = all(array.dtype == np.float32 for array in arrays)
    # Not ascontiguousarray: it turns scalars into rows.
    return [np.asarray(array, np.float32 if single else np.float64, order="C") for array in arrays]


def finite_rows(name: str, values: ArrayLike, *shape: int) -> NDArray[np.float64]:
    """Values as a float64 array (..., *shape). Raises ValueError on another shape, on NaN and on infinities."""
    array = _real(name, values).astype(np.float64, copy=False)
    if array.ndim < len(shape) or array.shape[array.ndim - len(shape) :] != shape:
        text = ", ".join(map(str, shape))
        raise ValueError(f"{name} has shape {array.shape}; expected ({text}{',' * (len(shape) == 1)}) or (..., {text})")
    if not all_finite(array):
        raise ValueError(f"{name} must be finite, but is {array}")
    return array


def finite_row(name: str, values: ArrayLike, width: int | None = None) -> NDArray[np.float64]:
    """Values as a float64 array (width,), of any length above 0 without a width. Raises ValueError as `finite_rows`."""
    row = finite_rows(name, values)
    if row.ndim != 1 or len(row) == 0 or (width is not None and len(row) != width):
        raise ValueError(f"{name} has shape {row.shape}; expected ({'n' if width is None else width},)")
    return row


def all_finite(array: NDArray[Any]) -> bool:
    """Whether no number is NaN or infinite."""
    if array.size <= _FEW:
        return all(map(math.isfinite, array.ravel().tolist()))
    return bool(np.isfinite(array).all())


def _real(name: str, values: ArrayLike) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name} holds {array.dtype}; expected real numbers")
    return array


def rate(name: str, value: float) -> float:
    """`value`, which is a share of a whole. Raises ValueError unless it is from 0 to 1."""
    if not 0 <= value <= 1:
        hint = f" ({value:g} % is {value / 100:g})" if 1 < value <= 100 else ""
        raise ValueError(f"{name} is {value:g}, expected 0 to 1{hint}")
    return value


def whole_number(name: str, value: Any, lowest: int, highest: int | None = None) -> int:
    """`value` as an int. Raises ValueError unless it is a whole number of `lowest` to `highest`, both included."""
    if type(value) is int and value >= lowest and (highest is None or value <= highest):
        return value
    expected = f"{lowest} or more" if highest is None else f"{lowest} to {highest}"
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} is {value!r}, expected a whole number of {expected}")
    if value < lowest or (highest is not None and value > highest):
        raise ValueError(f"{name} is {value}, expected {expected}")
    return int(value)


def whole(name: str, value: Any, lowest: int, highest: int | None = None) -> int:
    """As `whole_number`, for what people also write as 1e6: a float that is whole is taken."""
    return whole_number(name, as_whole(value), lowest, highest)


def as_whole(value: Any) -> Any:
    """The int that a whole float such as 1e4 stands for; anything else as it is."""
    return int(value) if isinstance(value, float | np.floating) and value.is_integer() else value
