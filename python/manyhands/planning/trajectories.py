"""Trajectories of joints and of frames."""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import planning as _core
from manyhands.arguments import choice, finite_rows, listed, number, real_array, whole_number
from manyhands.rigid_motions import unit_quaternions

Array = NDArray[np.float64]
CartesianPath: TypeAlias = Literal["straight", "screw"]


class Sample(NamedTuple):
    """A trajectory at the times t (...)."""

    q: Array
    """(..., n) positions"""
    v: Array
    """(..., n) velocities"""
    a: Array
    """(..., n) accelerations"""


class Trajectory:
    """n numbers as functions of time from 0 to `duration`: polynomials, one after the other. It never changes.

    breaks: (m + 1,) where pieces begin and end [s], rising from 0. coefficients: (m, order, n), of the powers of the
    time since a piece began, the lowest first. Raises ValueError on other shapes and numbers.
    """

    __slots__ = ("_motion",)

    def __init__(self, breaks: ArrayLike, coefficients: ArrayLike) -> None:
        self._motion = _core.Trajectory(_array("breaks", breaks, 1), _array("coefficients", coefficients, 3))

    @classmethod
    def _of(cls, motion: Any) -> "Trajectory":
        made = cls.__new__(cls)
        made._motion = motion
        return made

    @property
    def duration(self) -> float:
        """[s]"""
        return self._motion.duration

    @property
    def width(self) -> int:
        """n"""
        return self._motion.width

    @property
    def breaks(self) -> Array:
        """Where its polynomials begin, and the end: (m + 1) [s], rising from 0."""
        return np.asarray(self._motion.breaks)

    @property
    def coefficients(self) -> Array:
        """Of its polynomials (m, order, width), the lowest power first."""
        return np.asarray(self._motion.coefficients)

    def sample(self, t: ArrayLike) -> Sample:
        """Position, velocity and acceleration at the times t (...) [s]. Before 0 and after the duration the trajectory
        stands still at its ends."""
        times = finite_rows("t", t)
        return Sample(*_shaped(times, self._motion.sample(times.reshape(-1))))

    def part(self, start: float, end: float) -> "Trajectory":
        """What it does from `start` to `end` [s], as a trajectory that begins at 0. It stands still where this one
        does. Raises ValueError unless the end is later."""
        return Trajectory._of(self._motion.part(number("start", start), number("end", end)))

    def __reduce__(self) -> tuple[type["Trajectory"], tuple[Array, Array]]:
        return Trajectory, (self.breaks, self.coefficients)

    def __repr__(self) -> str:
        return f"Trajectory(width={self.width}, duration={self.duration:g}, pieces={len(self.breaks) - 1})"


def joined(motions: Sequence[Trajectory]) -> Trajectory:
    """Trajectories (n) one after the other, in time. Positions jump unless each begins where the one before ends.
    Raises ValueError if there are none, and on different n."""
    return Trajectory._of(_core.joined([motion._motion for motion in listed("motions", motions, Trajectory)]))


def standing(q: Array) -> Trajectory:
    """Stands still at q (n,), for a millisecond."""
    return Trajectory([0.0, 1e-3], q[None, None])


class CartesianSample(NamedTuple):
    """A frame's motion at the times t (...)."""

    position: Array
    """(..., 3) in the world [m]"""
    quaternion: Array
    """(..., 4) xyzw"""
    velocity: Array
    """(..., 6) angular velocity [rad/s] and velocity of the frame's origin [m/s], world axes"""
    acceleration: Array
    """(..., 6) their derivatives"""


class CartesianTrajectory:
    """A frame's motion through poses; `cartesian` makes it."""

    __slots__ = ("_motion", "law")

    law: Trajectory
    """where on its way it is: k at pose k"""

    def __init__(self, position: Array, quaternion: Array, law: Trajectory, path: CartesianPath) -> None:
        self.law = law
        self._motion = _core.CartesianTrajectory(position, quaternion, law._motion, path == "screw")

    @property
    def duration(self) -> float:
        """[s]"""
        return self.law.duration

    def sample(self, t: ArrayLike) -> CartesianSample:
        """Pose, velocity and acceleration at the times t (...) [s]."""
        times = finite_rows("t", t)
        return CartesianSample(*_shaped(times, self._motion.sample(times.reshape(-1))))


def cubic(times: ArrayLike, waypoints: ArrayLike, velocity: ArrayLike | None = None) -> Trajectory:
    """A cubic between every two waypoints (m, n), reached at times (m,) that rise from 0 [s].

    velocity: (m, n) at each waypoint; the acceleration then jumps there. Or (2, n) at both ends, by default rest: the
    velocities between are then those with which the acceleration is continuous.
    """
    t, q = _timed(times, waypoints)
    if velocity is None:
        velocity = np.zeros((2, q.shape[1]))
    v = _array("velocity", velocity, 2)
    if len(v) == 2 and len(q) > 2:
        return spline(t, q, 3, v[:, None])
    return Trajectory._of(_core.cubic(t, q, v))


def quintic(
    times: ArrayLike, waypoints: ArrayLike, velocity: ArrayLike | None = None, acceleration: ArrayLike | None = None
) -> Trajectory:
    """A quintic between every two waypoints (m, n), reached at times (m,) that rise from 0 [s].

    velocity, acceleration: both (m, n), at each waypoint. Or both (2, n) at the ends, by default rest: between, they
    are those with which the third and fourth derivatives are continuous.
    """
    t, q = _timed(times, waypoints)
    ends = np.zeros((2, q.shape[1]))
    v = _array("velocity", ends if velocity is None else velocity, 2)
    a = _array("acceleration", ends if acceleration is None else acceleration, 2)
    if len(v) == len(a) == 2 and len(q) > 2:
        if v.shape != a.shape:
            raise ValueError(f"velocity has shape {v.shape} and acceleration {a.shape}; expected {ends.shape}")
        return spline(t, q, 5, np.stack([v, a], axis=1))
    return Trajectory._of(_core.quintic(t, q, v, a))


def spline(times: ArrayLike, waypoints: ArrayLike, degree: int = 3, ends: ArrayLike | None = None) -> Trajectory:
    """The B-spline of degree 1, 3, 5 or 7 through waypoints (m, n) at times (m,) that rise from 0 [s].

    ends: (2, e, n), the first e derivatives at the start and at the end, e of 0 to (degree - 1) / 2. Without them the
    spline is free there ("not a knot") and needs degree + 1 waypoints; each derivative saves two.
    """
    t, q = _timed(times, waypoints)
    given = _array("ends", np.zeros((2, 0, q.shape[1])) if ends is None else ends, 3)
    if given.shape[0] != 2 or given.shape[2] != q.shape[1]:
        raise ValueError(f"ends has shape {given.shape}; expected (2, derivatives, {q.shape[1]})")
    return Trajectory._of(_core.spline(t, q, whole_number("degree", degree, 1, 7), given))


def trapezoid(waypoints: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> Trajectory:
    """The fastest motion in straight lines from waypoint to waypoint (m, n), at rest at each, that keeps every joint
    within its limits of velocity and acceleration, (n,) or one for all, above 0. Joints start and stop together; their
    velocities are trapezoids, or triangles on a short way."""
    q = _rows("waypoints", waypoints)
    return Trajectory._of(
        _core.trapezoid(
            q, limit_row("velocity", velocity, q.shape[1]), limit_row("acceleration", acceleration, q.shape[1])
        )
    )


def cartesian(
    position: ArrayLike, quaternion: ArrayLike, law: Trajectory | ArrayLike, path: CartesianPath = "straight"
) -> CartesianTrajectory:
    """A frame's motion through poses: position (m, 3) [m], quaternion xyzw (m, 4).

    law: the times (m,) at which it is there [s], with rest at each by quintics; or a trajectory of width 1 that is k at
    pose k, as `trapezoid` and `time_optimal` make them. path: "straight" moves the origin along lines while the frame
    turns evenly about one axis; "screw" turns about and shifts along one screw axis. Turns are the shorter ones.
    """
    p, r = _rows("position", position), unit_quaternions("quaternion", quaternion)
    if p.shape[1] != 3 or r.shape != (len(p), 4):
        raise ValueError(f"position has shape {p.shape} and quaternion {r.shape}; expected (m, 3) and (m, 4)")
    if not isinstance(law, Trajectory):
        rest = np.zeros((len(p), 1))
        law = quintic(_array("law", law, 1), np.arange(len(p), dtype=float)[:, None], rest, rest)
    return CartesianTrajectory(p, np.ascontiguousarray(r), law, choice("path", path, "straight", "screw"))


def limit_row(name: str, values: ArrayLike, n: int) -> Array:
    """Limits (n,), or one for all; infinite ones are none. The extension checks that they are above 0."""
    row = real_array(name, values).astype(np.float64, copy=False)
    if row.shape not in ((), (n,)):
        raise ValueError(f"{name} has shape {row.shape}; expected one number, or ({n},)")
    return np.ascontiguousarray(np.broadcast_to(row, (n,)))


def _array(name: str, values: ArrayLike, dimensions: int) -> Array:
    array = finite_rows(name, values)
    if array.ndim != dimensions:
        raise ValueError(f"{name} has shape {array.shape}; expected {dimensions} dimension{'s' * (dimensions > 1)}")
    return np.ascontiguousarray(array)


def _rows(name: str, values: ArrayLike) -> Array:
    """(m, n) with two rows and one column at least."""
    rows = _array(name, values, 2)
    if rows.shape[0] < 2 or rows.shape[1] < 1:
        raise ValueError(f"{name} has shape {rows.shape}; expected two rows and one column or more")
    return rows


def _timed(times: ArrayLike, waypoints: ArrayLike) -> tuple[Array, Array]:
    t, q = _array("times", times, 1), _rows("waypoints", waypoints)
    if len(t) != len(q):
        raise ValueError(f"there are {len(t)} times for {len(q)} waypoints; expected as many")
    return t, q


def _shaped(times: Array, found: Any) -> list[Array]:
    return [rows.reshape(*times.shape, rows.shape[1]) for rows in found]
