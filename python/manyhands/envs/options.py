"""Checks of what environments are made with, whose messages name the option."""

from collections.abc import Callable, Collection, Mapping
from numbers import Integral, Real
from typing import Any

import numpy as np


def _is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and abs(int(value)) < 2**31


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _are_numbers(count: int) -> Callable[[Any], bool]:
    def fits(value: Any) -> bool:
        try:
            array = np.asarray(value)
        except ValueError:  # rows of different lengths
            return False
        return array.shape == (count,) and array.dtype.kind in "iuf"

    return fits


def _is_place(value: Any) -> bool:
    return value is None or _are_numbers(3)(value)


_Kind = tuple[str, Callable[[Any], bool]]
_WHOLE: _Kind = "a whole number below 2**31", _is_whole
_NUMBER: _Kind = "a number", _is_number
_PAIR: _Kind = "two numbers, of translation and of rotation", _are_numbers(2)
_KINDS: dict[str, _Kind] = {
    "n_substeps": _WHOLE,
    "time_step": _NUMBER,
    "terminate_on_success": ("True or False", lambda value: isinstance(value, bool)),
    "distance_threshold": _NUMBER,
    "object_shape": ("'box', 'cylinder', 'sphere' or 'capsule'", lambda value: isinstance(value, str)),
    "stiffness": _PAIR,
    "damping": _PAIR,
    "render_width": _WHOLE,
    "render_height": _WHOLE,
    "render_target_position": ("three numbers or None", _is_place),
    "render_distance": _NUMBER,
    "render_yaw": _NUMBER,
    "render_pitch": _NUMBER,
    "render_roll": _NUMBER,
    "render_floor": ("three numbers or None", _is_place),
    "cameras": (
        "a dict of names and options, for example {'front': {}}",
        lambda value: value is None or isinstance(value, Mapping),
    ),
}


def require_known(given: Mapping[str, Any], known: Collection[str]) -> None:
    """Raises TypeError on an option that is not known; the message names it and what there is."""
    for name, value in given.items():
        if name not in known:
            raise TypeError(f"there is no option {name!r} (it is {value!r}); there are {', '.join(known)}")


def require_options(given: Mapping[str, Any], known: Collection[str]) -> None:
    """Raises TypeError on an option that is not known, or of another type; the message names it and what there is."""
    require_known(given, ("reward_type", "control_type", "render_mode", *known))
    for name, value in given.items():
        expected, fits = _KINDS.get(name, ("", None))
        if fits is not None and not fits(value):
            raise TypeError(f"{name} is {value!r}, expected {expected}")
