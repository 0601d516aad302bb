"""Guesses with which an inverse kinematics may begin."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.manipulapy.utils import logm, rotation_matrix_to_euler_angles

Array = NDArray[np.float64]
_ABOVE = 1e-6  # [m]: a goal this near the base's axis is above it
_NO_STRATEGY = "none (failed)"

Limits: TypeAlias = Sequence[tuple[float | None, float | None]]


def limit_array(limits: Limits, open_end: float) -> Array:
    """(n, 2), with -open_end and open_end where there is None or no finite number."""
    rows = [
        [-open_end if low is None else low, open_end if high is None else high]
        for low, high in ((pair[0], pair[1]) for pair in limits)
    ]
    array = np.asarray(rows, np.float64).reshape(-1, 2)
    return np.where(np.isfinite(array), array, [-open_end, open_end])


def clipped(theta: ArrayLike, limits: Limits) -> Array:
    """Angles within the limits, of which None is none."""
    bounds = limit_array(limits, np.inf)
    return np.clip(np.asarray(theta, np.float64), bounds[:, 0], bounds[:, 1])


def workspace_heuristic_guess(T_desired: ArrayLike, n_joints: int, joint_limits: Limits) -> Array:
    """The arm points at the goal, elbow half bent, wrist as the goal is turned; above the base it points ahead."""
    T = np.asarray(T_desired, np.float64)
    x, y, z = T[:3, 3]
    roll, pitch, yaw = rotation_matrix_to_euler_angles(T[:3, :3])
    reach, guess = np.hypot(x, y), np.zeros(n_joints)
    shape = [np.arctan2(y, x), np.arctan2(z, reach) if reach > _ABOVE else 0.0, np.pi / 4, yaw, pitch, roll][:n_joints]
    guess[: len(shape)] = shape
    return clipped(guess, joint_limits)


def extrapolate_from_current(
    theta_current: ArrayLike,
    T_current: ArrayLike,
    T_desired: ArrayLike,
    jacobian_func: Callable[[Array], Array],
    joint_limits: Limits,
    alpha: float = 0.5,
) -> Array:
    """A share alpha of the way to the goal, by the Jacobian at the present angles."""
    theta = np.asarray(theta_current, np.float64)
    twist = logm(np.asarray(T_desired) @ np.linalg.inv(np.asarray(T_current)))  # about the origin of space
    return clipped(theta + alpha * np.linalg.pinv(jacobian_func(theta)) @ twist, joint_limits)


def random_in_limits(joint_limits: Limits) -> Array:
    """Anywhere between the limits, half a turn each way where there are none, from numpy's global generator."""
    bounds = limit_array(joint_limits, np.pi)
    return np.random.uniform(bounds[:, 0], bounds[:, 1])  # noqa: NPY002


def midpoint_of_limits(joint_limits: Limits) -> Array:
    """Between the limits; 0 where one is open."""
    bounds = limit_array(joint_limits, np.inf)
    finite: Any = np.isfinite(bounds).all(1)
    return np.where(finite, np.where(finite[:, None], bounds, 0.0).mean(1), 0.0)


class IKInitialGuessCache:
    """Solutions that were found, the oldest forgotten first."""

    def __init__(self, max_size: int = 100) -> None:
        self.max_size = max_size
        self._known: deque[tuple[Array, Array]] = deque(maxlen=max_size)

    def add(self, T: ArrayLike, theta: ArrayLike, residual: float | None = None) -> None:
        del residual
        self._known.append((np.array(T, np.float64), np.array(theta, np.float64)))

    def get_nearest(self, T_desired: ArrayLike, k: int = 3, joint_limits: Limits | None = None) -> Array | None:
        """The mean of the angles of the k nearest poses, weighted by nearness; None if there are none."""
        if not self._known:
            return None
        goal = np.asarray(T_desired, np.float64)
        distances = np.array(
            [
                np.linalg.norm(T[:3, 3] - goal[:3, 3]) + 0.1 * np.linalg.norm(T[:3, :3] - goal[:3, :3])
                for T, _ in self._known
            ]
        )
        order = np.argsort(distances, kind="stable")[:k]
        weights = 1 / (distances[order] + 1e-6)
        theta = np.average([self._known[i][1] for i in order], axis=0, weights=weights)
        return theta if joint_limits is None else clipped(theta, joint_limits)

    def clear(self) -> None:
        self._known.clear()

    def size(self) -> int:
        return len(self._known)


def adaptive_multi_start_ik(
    ik_solver_func: Callable[..., tuple[Array, bool, int]],
    T_desired: ArrayLike,
    max_attempts: int = 10,
    eomg: float = 2e-3,
    ev: float = 2e-3,
    max_iterations: int = 5000,
    verbose: bool = False,
) -> tuple[Array, bool, int, str]:
    """Calls a solver with one strategy after the other until it succeeds: angles, success, iterations of all attempts,
    and the strategy. Where none succeeds, the angles are the first's, since solvers do not say how near they came, and
    the strategy is "none (failed)"."""
    strategies = ("workspace_heuristic", "midpoint", "random")
    first: Array | None = None
    total = 0
    for attempt in range(max(1, max_attempts)):
        strategy = strategies[min(attempt, len(strategies) - 1)]
        theta, success, iterations = ik_solver_func(
            T_desired, strategy=strategy, eomg=eomg, ev=ev, max_iterations=max_iterations
        )
        total += iterations
        first = theta if first is None else first
        if verbose:
            print(f"attempt {attempt + 1}, {strategy}: {'reached' if success else 'not reached'}")
        if success:
            return theta, True, total, strategy
    assert first is not None
    return first, False, total, _NO_STRATEGY
