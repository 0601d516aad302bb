"""Jerk-limited motions that are found while a robot moves, by Ruckig.

A motion begins in any state and ends at a goal at rest or not, as soon as limits of velocity, acceleration and jerk
let it; joints arrive together. Finding one takes microseconds, so a new goal is followed from the next sample on. Needs
the extra `online`.

L. Berscheid, T. Kröger, Jerk-limited real-time trajectory generation with arbitrary target states, RSS 2021.
"""

import re
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.arguments import bounded, finite_row, number
from manyhands.extras import needs
from manyhands.planning.trajectories import Sample, Trajectory

with needs("online", "manyhands.planning.online"):
    import ruckig

__all__ = ["Follower", "jerk_limited", "links", "stop"]

Array = NDArray[np.float64]
_A_HAIR_LESS = 1 - 1e-7
_SHORTEST = 1e-9  # [s] of a piece; shorter ones are rounding


def jerk_limited(
    start: ArrayLike,
    goal: ArrayLike,
    *,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
    start_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    goal_velocity: ArrayLike | None = None,
    goal_acceleration: ArrayLike | None = None,
) -> Trajectory:
    """The fastest motion from `start` to `goal` (n,), with velocities and accelerations (n,) there, by default 0.

    velocity, acceleration, jerk: limits (n,), or one for all, above 0. A start beyond a limit is braked first. Raises
    ValueError on arrays that do not fit, on goals that limits forbid, and where numbers are so far apart that none is
    found.
    """
    given = _request(start, start_velocity, start_acceleration, velocity, acceleration, jerk)
    _set_goal(given, goal, goal_velocity, goal_acceleration)
    return _as_polynomials(_calculate(given))


def stop(
    start: ArrayLike,
    start_velocity: ArrayLike,
    start_acceleration: ArrayLike,
    *,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
) -> Trajectory:
    """The fastest motion to rest from a state (n,), wherever that is; limits as of `jerk_limited`. Each joint comes to
    rest as soon as it can."""
    given = _request(start, start_velocity, start_acceleration, velocity, acceleration, jerk)
    given.control_interface = ruckig.ControlInterface.Velocity
    given.synchronization = ruckig.Synchronization.No
    given.target_velocity = given.target_acceleration = [0.0] * given.degrees_of_freedom
    return _as_polynomials(_calculate(given))


def links(
    start: Sample, goals: Iterable[Sample], *, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike
) -> list[tuple[float, int, Callable[[], Trajectory]]]:
    """`jerk_limited` from one state to many: of those that limits allow how long it takes [s], which goal's it is, and
    what makes the motion."""
    given = _request(*start, velocity, acceleration, jerk)
    found = []
    for k, goal in enumerate(goals):
        _set_goal(given, *goal)
        try:
            motion = _calculate(given)
        except ValueError:
            continue
        found.append((motion.duration, k, partial(_as_polynomials, motion)))
    return found


class Follower:
    """A state (n,) that follows goals, a time step dt [s] after another, within limits as those of `jerk_limited`."""

    def __init__(
        self, start: ArrayLike, dt: float, *, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike
    ) -> None:
        q = finite_row("start", start)
        self._given, self._found = ruckig.InputParameter(len(q)), ruckig.OutputParameter(len(q))
        self._ruckig = ruckig.Ruckig(len(q), number("dt", dt, above=0))
        _set_limits(self._given, velocity, acceleration, jerk)
        self._given.current_position = q.tolist()

    def step(
        self, goal: ArrayLike, goal_velocity: ArrayLike | None = None, goal_acceleration: ArrayLike | None = None
    ) -> Sample:
        """The state dt later, on the fastest way to the goal (n,), which may be another one at each step."""
        _set_goal(self._given, goal, goal_velocity, goal_acceleration)
        _solve(self._given, lambda: self._ruckig.update(self._given, self._found))
        self._found.pass_to_input(self._given)
        found = self._found
        return Sample(*map(np.array, (found.new_position, found.new_velocity, found.new_acceleration)))


def _solve(given: Any, calculate: Callable[[], object]) -> None:
    """Calculates, and once more with a velocity a hair lower: Ruckig 0.19.4 finds nothing for some ways that just reach
    the limits of velocity and acceleration, as 0.2 within 1, 10 and a jerk of 100."""
    try:
        calculate()
    except ruckig.RuckigError as error:
        limits = given.max_velocity
        given.max_velocity = [_A_HAIR_LESS * limit for limit in limits]
        try:
            calculate()
        except ruckig.RuckigError:
            raise ValueError(_in_words(str(error), given)) from None
        finally:
            given.max_velocity = limits


def _in_words(error: str, given: Any) -> str:
    """What Ruckig refuses, by the names of our arguments; it finds nothing where double precision does not suffice."""
    told = re.search(r"(target|current) (velocity|acceleration) (\S+) of DoF (\d+) exceeds its .* limit (\S+)\.", error)
    if told is not None:
        end, what, value, joint, limit = told.groups()
        return f"{'goal' if end == 'target' else 'start'}_{what} of joint {joint} is {value}, beyond its limit {limit}"
    way = f"from {given.current_position} at {given.current_velocity} to {given.target_position}"
    limits = f"velocity {given.max_velocity}, acceleration {given.max_acceleration} and jerk {given.max_jerk}"
    return f"no motion {way} was found within {limits}: these numbers are too large, or too far apart, for each other"


def _request(
    start: ArrayLike,
    start_velocity: ArrayLike | None,
    start_acceleration: ArrayLike | None,
    velocity: ArrayLike,
    acceleration: ArrayLike,
    jerk: ArrayLike,
) -> Any:
    q = finite_row("start", start)
    given = ruckig.InputParameter(len(q))
    _set_limits(given, velocity, acceleration, jerk)
    given.current_position = q.tolist()
    given.current_velocity = _state("start_velocity", start_velocity, len(q))
    given.current_acceleration = _state("start_acceleration", start_acceleration, len(q))
    return given


def _calculate(given: Any) -> Any:
    found = ruckig.Trajectory(given.degrees_of_freedom)
    solver = ruckig.Ruckig(given.degrees_of_freedom)
    _solve(given, lambda: solver.calculate(given, found))
    return found


def _state(name: str, values: ArrayLike | None, n: int) -> list[float]:
    return [0.0] * n if values is None else finite_row(name, values, n).tolist()


def _set_goal(given: Any, goal: ArrayLike, velocity: ArrayLike | None, acceleration: ArrayLike | None) -> None:
    n = given.degrees_of_freedom
    given.target_position = _state("goal", goal, n)
    given.target_velocity = _state("goal_velocity", velocity, n)
    given.target_acceleration = _state("goal_acceleration", acceleration, n)


def _set_limits(given: Any, velocity: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> None:
    for name, values in (("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)):
        setattr(given, f"max_{name}", bounded(name, values, given.degrees_of_freedom, above=0).tolist())


def _as_polynomials(found: Any) -> Trajectory:
    """Cubics between the times at which the jerk of some joint changes."""
    changes = [[0.0, found.duration]]
    for profile in found.profiles[0]:
        changes += [np.cumsum(profile.brake.t), profile.brake.duration + np.cumsum([0.0, *profile.t])]
    times = np.sort(np.concatenate(changes))  # np.unique imports much when it is first called
    times = times[(times <= found.duration) & (np.diff(times, prepend=-1.0) > _SHORTEST)]
    if len(times) < 2:
        raise ValueError("start and goal are the same state; there is nothing to do")
    q, v, a = (np.array(rows) for rows in zip(*map(found.at_time, times.tolist()), strict=True))
    jerk = np.diff(a, axis=0) / np.diff(times)[:, None]
    return Trajectory(times, np.stack([q[:-1], v[:-1], a[:-1] / 2, jerk / 6], axis=1))
