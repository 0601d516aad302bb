"""Constraints that a plan keeps all along its way: how an axis of a frame points, and where a frame is."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from manyhands._core import planning as _core
from manyhands.arguments import bounded, finite_row, instance, listed, number
from manyhands.rigid_motions import unit_quaternions

_UP = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class AxisConstraint:
    """An axis of a frame stays within an angle of a direction: a cup upright, a camera that looks down."""

    frame: str
    """a link or frame that planned joints move, or one that is attached to such"""
    axis: ArrayLike = _UP
    """(3,) in the frame"""
    within: float = 0.1
    """the angle [rad], 0.01 or more"""
    direction: ArrayLike = _UP
    """(3,) in the world"""

    def __post_init__(self) -> None:
        _core.check_path_constraints(*as_rows(self))


def upright(frame: str, axis: ArrayLike = _UP, within: float = 0.1) -> AxisConstraint:
    """The axis (3,) of the frame points upwards, within an angle [rad]."""
    return AxisConstraint(frame, axis, within)


@dataclass(frozen=True)
class PositionConstraint:
    """A frame's origin stays within bounds along the axes of a reference pose."""

    frame: str
    """a link or frame that planned joints move, or one that is attached to such"""
    lower: ArrayLike = (-np.inf, -np.inf, -np.inf)
    """(3,) along the reference's axes, from its origin [m]; infinite numbers do not bound"""
    upper: ArrayLike = (np.inf, np.inf, np.inf)
    """(3,) a millimetre above lower, or more [m]"""
    position: ArrayLike = (0.0, 0.0, 0.0)
    """(3,) of the reference in the world [m]"""
    quaternion: ArrayLike = (0.0, 0.0, 0.0, 1.0)
    """(4,) xyzw of the reference"""

    def __post_init__(self) -> None:
        _core.check_path_constraints(*as_rows(self))


PathConstraint: TypeAlias = AxisConstraint | PositionConstraint


def as_rows(keep: PathConstraint | Sequence[PathConstraint]) -> tuple[list[Any], list[Any]]:
    """Of axes and of positions, as the extension takes them. Raises TypeError on what is no constraint, ValueError on
    bad shapes and NaN."""
    axes: list[Any] = []
    positions: list[Any] = []
    single = isinstance(keep, AxisConstraint | PositionConstraint)
    for one in [keep] if single else listed("keep", keep, AxisConstraint, PositionConstraint):
        frame = instance("frame", one.frame, str)
        if isinstance(one, AxisConstraint):
            vectors = (finite_row(name, getattr(one, name), 3) for name in ("axis", "direction"))
            axes.append((frame, *vectors, number("within", one.within)))
        else:
            bounds = (_bounds(name, getattr(one, name)) for name in ("lower", "upper"))
            turn = unit_quaternions("quaternion", one.quaternion)
            positions.append(
                (frame, finite_row("position", one.position, 3), finite_row("quaternion", turn, 4), *bounds)
            )
    return axes, positions


def _bounds(name: str, values: ArrayLike) -> Any:
    row = bounded(name, values, infinite=True)
    if row.shape != (3,):
        raise ValueError(f"{name} has shape {row.shape}; expected (3,), infinite where there is no bound")
    return row
