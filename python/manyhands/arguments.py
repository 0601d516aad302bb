"""Checks of arguments whose messages name the argument."""

import math
from collections.abc import Iterable
from reprlib import repr as short
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_THREADS = 1024
_FEW = 32  # numbers that Python looks at faster than numpy does

T = TypeVar("T")

FloatArray = NDArray[Any]
"""float32 or float64, as the input."""


def float_arrays(**inputs: ArrayLike) -> list[FloatArray]:
    """The inputs as C-contiguous arrays of one type: float32 if all are, else float64."""
    arrays = [real_array(name, values) for name, values in inputs.items()]
    single = all(array.dtype == np.float32 for array in arrays)
    # Not ascontiguousarray: it turns scalars into rows.
    return [np.asarray(array, np.float32 if single else np.float64, order="C") for array in arrays]


def finite_rows(name: str, values: ArrayLike, *shape: int) -> NDArray[np.float64]:
    """Values as a float64 array (..., *shape). Raises ValueError on another shape, on NaN and on infinities."""
    array = real_array(name, values).astype(np.float64, copy=False)
    if array.ndim < len(shape) or array.shape[array.ndim - len(shape) :] != shape:
        text = ", ".join(map(str, shape))
        raise ValueError(f"{name} has shape {array.shape}; expected ({text}{',' * (len(shape) == 1)}) or (..., {text})")
    if not all_finite(array):
        raise ValueError(f"{name} must be finite, but is {array}")
    return array


def cloud_rows(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Points as a float64 array (m, 3), finite or not; an empty list is none. Raises ValueError on other shapes."""
    points = real_array(name, values).astype(np.float64, order="C", copy=False)
    if points.shape == (0,):
        return points.reshape(0, 3)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"{name} has shape {points.shape}; expected (m, 3)")
    return points


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


def real_array(name: str, values: ArrayLike) -> NDArray[Any]:
    """Values as an array of real numbers, of their own type. Raises ValueError on anything else."""
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name} has rows of several lengths; expected an array") from None
    if array.dtype.kind not in "biuf":
        given = f"is {brief(values)}" if array.ndim == 0 else f"holds {array.dtype}"
        raise ValueError(f"{name} {given}; expected real numbers")
    return array


def bounded(
    name: str,
    values: ArrayLike,
    n: int | None = None,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    infinite: bool = False,
) -> NDArray[np.float64]:
    """One number for all, or (n,) of them, as a float64 array (n,); without n of any shape, as they are. Raises
    ValueError on another shape, on NaN, beyond the bounds, and on infinity unless that is let through."""
    array = real_array(name, values).astype(np.float64, copy=False)
    if n is not None and array.shape not in ((), (n,)):
        raise ValueError(f"{name} has shape {array.shape}; expected one number, or ({n},)")
    fits = ~np.isnan(array) if infinite else np.isfinite(array)
    if not np.all(fits & (array >= least) & ((array > above) | (above == -math.inf))):
        what = "numbers" if infinite else "finite numbers"
        raise ValueError(f"{name} is {array}; expected {_expected(what, above, least, math.inf)}")
    return array if n is None else np.ascontiguousarray(np.broadcast_to(array, (n,)))


def together(**arrays: NDArray[Any]) -> list[NDArray[Any]]:
    """The arrays, all of one shape. Raises ValueError, which names them, where they do not broadcast."""
    try:
        return list(np.broadcast_arrays(*arrays.values()))
    except ValueError:
        shapes = " and ".join(f"{name} has shape {array.shape}" for name, array in arrays.items())
        raise ValueError(f"{shapes}; expected one shape, or single numbers") from None


def number(
    name: str,
    value: Any,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    most: float = math.inf,
    infinite: bool = False,
) -> float:
    """`value` as a float. Raises TypeError unless it is one number, ValueError on NaN, beyond the bounds, and on
    infinity unless that is let through."""
    x = _single(name, value)
    if (infinite or math.isfinite(x)) and (x > above or above == -math.inf) and least <= x <= most:
        return x
    what = "a number" if infinite else "a finite number"
    raise ValueError(f"{name} is {value}; expected {_expected(what, above, least, most)}")


def _single(name: str, value: Any) -> float:
    if not hasattr(value, "__float__") or (isinstance(value, np.ndarray) and value.ndim > 0):
        raise TypeError(f"{name} is {brief(value)}; expected a number")
    return float(value)


def _expected(what: str, above: float, least: float, most: float) -> str:
    if above > -math.inf:
        return f"{what} above {above:g}" + (f", {most:g} at most" if most < math.inf else "")
    if least > -math.inf:
        return f"{what} of {least:g} or more" if most == math.inf else f"{what} of {least:g} to {most:g}"
    return what


def instance(name: str, value: Any, *kinds: type[T], hint: str = "") -> T:
    """`value`. Raises TypeError unless it is of one of the kinds; hint: where one comes from."""
    if isinstance(value, kinds):
        return value
    expected = " or ".join(kind.__name__ for kind in kinds)
    raise TypeError(f"{name} is {brief(value)}; expected {expected}{hint and ', ' + hint}")


def choice(name: str, value: Any, *allowed: T) -> T:
    """`value`. Raises ValueError unless it is one of those allowed."""
    for one in allowed:
        if isinstance(value, str) and one == value:
            return one
    *others, last = map(repr, allowed)
    raise ValueError(f"{name} is {brief(value)}; expected {', '.join(others)} or {last}")


def listed(name: str, values: Iterable[T], *kinds: type[T]) -> list[T]:
    """What is given, one after the other. Raises TypeError on what is no list, and on what is of another kind in it."""
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        expected = " or ".join(kind.__name__ for kind in kinds)
        raise TypeError(f"{name} is {brief(values)}; expected a list of {expected}")
    return [instance(f"{name}[{i}]", value, *kinds) for i, value in enumerate(values)]


def brief(value: Any) -> str:
    """What a message shows of a value, in a line."""
    return " ".join(short(value).split())


def rate(name: str, value: float) -> float:
    """`value`, which is a share of a whole. Raises ValueError unless it is from 0 to 1."""
    share = _single(name, value)
    if not 0 <= share <= 1:
        hint = f" ({share:g} % is {share / 100:g})" if 1 < share <= 100 else ""
        raise ValueError(f"{name} is {share:g}, expected 0 to 1{hint}")
    return share


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
