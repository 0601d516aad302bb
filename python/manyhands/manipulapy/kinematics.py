"""Forward and inverse kinematics of a serial arm, given as screws (Lynch, Park: Modern Robotics, 2017)."""

import os
import time
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _kinematics
from manyhands._core.kinematics import ScrewChain
from manyhands.manipulapy import utils
from manyhands.manipulapy.ik_helpers import (
    IKInitialGuessCache,
    Limits,
    adaptive_multi_start_ik,
    extrapolate_from_current,
    limit_array,
    midpoint_of_limits,
    random_in_limits,
    workspace_heuristic_guess,
)
from manyhands.manipulapy.serial_model import TIP, serial_model

Array = NDArray[np.float64]
Frame = Literal["space", "body"]

_core: Any = _kinematics  # its arrays are all of one type

__all__ = ["SerialManipulator", "TracIKSolver", "trac_ik_solve"]


class SerialManipulator:
    """A chain of joints, each a screw: one column of the space axes S_list (6, n) and the body axes B_list (6, n).

    M_list: the pose (4, 4) of the end effector where all angles are 0, or a stack of which the last counts. Screws may
    be left out where omega_list (3, n) and points r_list or b_list (n, 3) say the same. joint_limits: (low, high) of
    each joint, None for none. G_list is kept for those who ask.
    """

    def __init__(
        self,
        M_list: ArrayLike,
        omega_list: ArrayLike,
        r_list: ArrayLike | None = None,
        b_list: ArrayLike | None = None,
        S_list: ArrayLike | None = None,
        B_list: ArrayLike | None = None,
        G_list: Any = None,
        joint_limits: Limits | None = None,
    ) -> None:
        M = np.asarray(M_list, np.float64)
        self.M_list = M[-1] if M.ndim == 3 else M
        self.omega_list = np.asarray(omega_list, np.float64)
        if S_list is None and r_list is not None:
            S_list = utils.extract_screw_list(self.omega_list, r_list)
        if B_list is None and b_list is not None:
            B_list = utils.extract_screw_list(self.omega_list, b_list)
        if S_list is None and B_list is None:
            raise ValueError("an arm needs S_list, B_list, r_list or b_list")
        if S_list is None:
            S_list = utils.adjoint_transform(self.M_list) @ np.asarray(B_list, np.float64)
        if B_list is None:
            B_list = utils.adjoint_transform(utils.TransInv(self.M_list)) @ np.asarray(S_list, np.float64)
        self.S_list, self.B_list = np.asarray(S_list, np.float64), np.asarray(B_list, np.float64)
        self.r_list = utils.extract_r_list(self.S_list) if r_list is None else np.asarray(r_list, np.float64)
        self.b_list = utils.extract_r_list(self.B_list) if b_list is None else np.asarray(b_list, np.float64)
        self.G_list = G_list
        n = self.S_list.shape[1]
        self.joint_limits = [(None, None)] * n if joint_limits is None else joint_limits
        self.joint_positions, self.joint_velocities = np.zeros(n), np.zeros(n)
        self._chain = ScrewChain(np.ascontiguousarray(self.M_list), np.ascontiguousarray(self.S_list))

    @property
    def joint_limits(self) -> Limits:
        """(low, high) of each joint; None is none."""
        return self._limits

    @joint_limits.setter
    def joint_limits(self, limits: Limits) -> None:
        self._limits, self._model = list(limits), None
        self._low, self._high = limit_array(limits, np.inf).T

    @property
    def model(self) -> Model:
        """The arm as a model of manyhands; its frame "tip" is the end effector."""
        if self._model is None:
            self._model = serial_model(self.M_list, self.S_list, limits=list(self.joint_limits))
        return self._model

    def forward_kinematics(self, thetalist: ArrayLike, frame: Frame = "space") -> Array:
        """The pose (4, 4) of the end effector. Both forms of the product say the same; a shorter list moves the first
        joints only."""
        if frame not in ("space", "body"):
            raise ValueError(f"Invalid frame specified: {frame!r}; choose 'space' or 'body'")
        return self._chain.pose(np.asarray(thetalist, np.float64))

    def jacobian(self, thetalist: ArrayLike, frame: Frame = "space") -> Array:
        """(6, n), angular first, in the space or the body form."""
        if frame not in ("space", "body"):
            raise ValueError(f"Invalid frame specified: {frame!r}; choose 'space' or 'body'")
        return self._chain.jacobian(np.asarray(thetalist, np.float64), frame == "body")

    def end_effector_pose(self, thetalist: ArrayLike) -> Array:
        """(6,): position [m], then roll, pitch and yaw [rad]."""
        T = self.forward_kinematics(thetalist)
        return np.concatenate([T[:3, 3], utils.rotation_matrix_to_euler_angles(T[:3, :3])])

    def end_effector_velocity(self, thetalist: ArrayLike, dthetalist: ArrayLike, frame: Frame = "space") -> Array:
        """The twist (6,) of the end effector."""
        return self.jacobian(thetalist, frame) @ np.asarray(dthetalist, np.float64)

    def joint_velocity(self, thetalist: ArrayLike, V_ee: ArrayLike, frame: Frame = "space") -> Array:
        """Joint velocities (n,) of least squares that give a twist (6,)."""
        return np.linalg.pinv(self.jacobian(thetalist, frame)) @ np.asarray(V_ee, np.float64)

    def update_state(self, joint_positions: ArrayLike, joint_velocities: ArrayLike | None = None) -> None:
        """Keeps positions and velocities."""
        self.joint_positions = np.array(joint_positions, np.float64)
        self.joint_velocities = (
            np.zeros_like(self.joint_positions) if joint_velocities is None else np.array(joint_velocities, np.float64)
        )

    def iterative_inverse_kinematics(
        self,
        T_desired: ArrayLike,
        thetalist0: ArrayLike,
        eomg: float = 1e-6,
        ev: float = 1e-6,
        max_iterations: int = 10000,
        plot_residuals: bool = False,
        damping: float = 2e-2,
        step_cap: float = 0.3,
        png_name: str = "ik_residuals.png",
        weight_orientation: float = 1.0,
        weight_position: float = 1.0,
        adaptive_tuning: bool = False,
        backtracking: bool = False,
    ) -> tuple[Array, bool, int]:
        """Angles (n,) within the limits that bring the end effector to a pose (4, 4): angles, success, attempts.

        Damped least squares in C++ from thetalist0, then from up to 30 random places. eomg [rad], ev [m]: what is
        reached. damping, step_cap, adaptive_tuning, backtracking and max_iterations tune a loop that is not here, but
        max_iterations 0 returns the start. plot_residuals writes png_name: errors after each attempt.
        """
        del damping, step_cap, adaptive_tuning, backtracking
        start = self._within(thetalist0)
        goal = np.asarray(T_desired, np.float64)
        if max_iterations < 1:
            return start, self._errors(start, goal, eomg, ev), 0
        theta, success = start, False
        attempts = 0
        errors: list[tuple[float, float]] = []
        for restarts in (0, 30):
            found = self._solve(goal, start, eomg, ev, restarts, weight_position, weight_orientation)
            attempts += 1 + restarts
            theta, success = found[:2]
            errors.append(found[2:])
            if success:
                break
        if plot_residuals:
            _plot_residuals(errors, png_name)
        return theta, success, min(attempts, max_iterations)

    def smart_inverse_kinematics(
        self,
        T_desired: ArrayLike,
        strategy: str = "workspace_heuristic",
        theta_current: ArrayLike | None = None,
        T_current: ArrayLike | None = None,
        cache: IKInitialGuessCache | None = None,
        eomg: float = 1e-6,
        ev: float = 1e-6,
        max_iterations: int = 10000,
        auto_fallback: bool = True,
        **options: Any,
    ) -> tuple[Array, bool, int]:
        """The same from a guess: "workspace_heuristic", "extrapolate" (from theta_current), "cached", "random" or
        "midpoint". What lacks its arguments falls back to the first."""
        guess = self._guess(np.asarray(T_desired, np.float64), strategy, theta_current, T_current, cache)
        found = self.iterative_inverse_kinematics(T_desired, guess, eomg, ev, max_iterations, **options)
        if not found[1] and auto_fallback:
            middle = midpoint_of_limits(self.joint_limits)
            again = self.iterative_inverse_kinematics(T_desired, middle, eomg, ev, max_iterations, **options)
            found = (again[0] if again[1] else found[0], again[1], found[2] + again[2])
        if found[1] and cache is not None:
            cache.add(T_desired, found[0])
        return found

    def robust_inverse_kinematics(
        self,
        T_desired: ArrayLike,
        max_attempts: int = 10,
        eomg: float = 2e-3,
        ev: float = 2e-3,
        max_iterations: int = 5000,
        verbose: bool = False,
    ) -> tuple[Array, bool, int, str]:
        """The same from as many guesses as it takes: angles, success, attempts, and the strategy that found them."""

        def solve(T: ArrayLike, **options: Any) -> tuple[Array, bool, int]:
            return self.smart_inverse_kinematics(T, auto_fallback=False, **options)

        return adaptive_multi_start_ik(solve, T_desired, max_attempts, eomg, ev, max_iterations, verbose)

    def trac_ik(
        self,
        T_desired: ArrayLike,
        theta0: ArrayLike | None = None,
        timeout: float = 0.2,
        eomg: float = 1e-4,
        ev: float = 1e-4,
        num_restarts: int = 5,
        use_parallel: bool = False,
    ) -> tuple[Array, bool, float]:
        """The same within a time [s]: angles, success, and the seconds it took. After theta0 it starts from up to 140
        random places. num_restarts and use_parallel have nothing to tune."""
        del num_restarts, use_parallel
        begin = time.perf_counter()
        goal = np.asarray(T_desired, np.float64)
        guess = workspace_heuristic_guess(goal, self.S_list.shape[1], self.joint_limits) if theta0 is None else theta0
        start = self._within(guess)
        theta, success = start, False
        for restarts in (0, 10, 30, 100):
            theta, success, _, _ = self._solve(goal, start, eomg, ev, restarts, 1.0, 1.0)
            if success or time.perf_counter() - begin > timeout:
                break
        return theta, success, time.perf_counter() - begin

    def _guess(
        self,
        goal: Array,
        strategy: str,
        theta_current: ArrayLike | None,
        T_current: ArrayLike | None,
        cache: IKInitialGuessCache | None,
    ) -> Array:
        n, limits = self.S_list.shape[1], self.joint_limits
        if strategy == "random":
            return random_in_limits(limits)
        if strategy == "midpoint":
            return midpoint_of_limits(limits)
        if strategy == "cached":
            known = None if cache is None else cache.get_nearest(goal, joint_limits=limits)
            return workspace_heuristic_guess(goal, n, limits) if known is None else known
        if strategy == "extrapolate" and theta_current is not None:
            here = self.forward_kinematics(theta_current) if T_current is None else T_current
            return extrapolate_from_current(theta_current, here, goal, self.jacobian, limits)
        if strategy in ("workspace_heuristic", "extrapolate"):
            return workspace_heuristic_guess(goal, n, limits)
        raise ValueError(
            f"unknown strategy {strategy!r}; there are workspace_heuristic, extrapolate, cached, random and midpoint"
        )

    def _solve(
        self, goal: Array, start: ArrayLike, eomg: float, ev: float, restarts: int, position: float, rotation: float
    ) -> tuple[Array, bool, float, float]:
        """Angles, success, and the errors [rad, m] that remain; as `manyhands.kinematics.inverse`, without its checks,
        which take longer than a solve from nearby."""
        if goal.shape != (4, 4) or not np.isfinite(goal).all():
            raise ValueError(f"T_desired must be a finite pose (4, 4), but is {goal}")
        parts = goal[:3, 3] if position > 0 else None, _core.quaternions(goal[:3, :3].reshape(1, 9))[0], None, None
        q, success, far, turned = _core.inverse(
            self.model, TIP, *parts, None, None, position if position > 0 else 1.0, rotation, "", None,
            np.asarray(start, np.float64), restarts, 0, True, ev, eomg,
        )  # fmt: skip
        return q, success, turned, far

    def _within(self, theta: ArrayLike) -> Array:
        """Angles within the limits."""
        return np.minimum(np.maximum(np.asarray(theta, np.float64), self._low), self._high)

    def _errors(self, theta: Array, goal: Array, eomg: float, ev: float) -> bool:
        here = self.forward_kinematics(theta)
        turn = utils.rotation_logm(goal[:3, :3] @ here[:3, :3].T)[1]
        return bool(turn < eomg and np.linalg.norm(goal[:3, 3] - here[:3, 3]) < ev)


class TracIKSolver:
    """`SerialManipulator.trac_ik` of an arm that is given by its functions.

    fk_func: angles (n_joints,) to the pose (4, 4) of the end effector. jacobian_func: angles to the space Jacobian
    (6, n_joints), angular first. joint_limits: (low, high) of each joint, None for none; `bounds` has 2 pi in its
    place. error_func is kept for those who ask: errors are the angle [rad] and the distance [m], and where another
    measure is given `solve` raises NotImplementedError.
    """

    def __init__(
        self,
        fk_func: Callable[[Array], ArrayLike],
        jacobian_func: Callable[[Array], ArrayLike],
        joint_limits: Limits,
        n_joints: int,
        error_func: Callable[..., Any] | None = None,
    ) -> None:
        if len(joint_limits) != n_joints:
            raise ValueError(f"joint_limits has {len(joint_limits)} pairs; expected n_joints, {n_joints}")
        self.fk_func, self.jacobian_func, self.error_func = fk_func, jacobian_func, error_func
        self.joint_limits, self.n_joints = joint_limits, n_joints
        self.bounds: list[tuple[float, float]] = [tuple(pair) for pair in limit_array(joint_limits, 2 * np.pi).tolist()]
        self._arm: SerialManipulator | None = None

    def solve(
        self,
        T_desired: ArrayLike,
        theta0: ArrayLike | None = None,
        timeout: float = 0.2,
        eomg: float = 1e-4,
        ev: float = 1e-4,
        num_restarts: int = 5,
        use_parallel: bool = False,
    ) -> tuple[Array, bool, float]:
        """Angles, success, seconds. Raises ValueError where the functions are not those of one serial arm."""
        if self.error_func is not None:
            raise NotImplementedError("errors are the angle and the distance; leave error_func out")
        if self._arm is None:
            self._arm = self._serial_arm()
        return self._arm.trac_ik(T_desired, theta0, timeout, eomg, ev, num_restarts, use_parallel)

    def _serial_arm(self) -> SerialManipulator:
        """The space Jacobian at zero is the arm's screws; a pose elsewhere tells whether they say it all."""
        zero, elsewhere = np.zeros(self.n_joints), np.linspace(0.3, 0.9, self.n_joints)
        screws = np.asarray(self.jacobian_func(zero), np.float64)
        arm = SerialManipulator(self.fk_func(zero), screws[:3], S_list=screws, joint_limits=self.bounds)
        if not np.allclose(arm.forward_kinematics(elsewhere), self.fk_func(elsewhere), atol=1e-6):
            raise ValueError(
                "fk_func is not the chain of screws that jacobian_func has at 0; is it the space Jacobian?"
            )
        return arm


def trac_ik_solve(
    robot: SerialManipulator,
    T_desired: ArrayLike,
    theta0: ArrayLike | None = None,
    timeout: float = 0.2,
    eomg: float = 1e-4,
    ev: float = 1e-4,
    num_restarts: int = 5,
    use_parallel: bool = False,
) -> tuple[Array, bool, float]:
    """`SerialManipulator.trac_ik` as a function."""
    return robot.trac_ik(T_desired, theta0, timeout, eomg, ev, num_restarts, use_parallel)


def _plot_residuals(errors: Sequence[tuple[float, float]], png_name: str | os.PathLike[str]) -> None:
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axis = figure.add_subplot()
    for name, values in zip(("rotation [rad]", "position [m]"), zip(*errors, strict=True), strict=True):
        axis.semilogy(range(1, len(values) + 1), np.maximum(values, 1e-16), marker="o", label=name)
    axis.set(xlabel="attempt", ylabel="error", title="Inverse kinematics")
    axis.legend()
    figure.savefig(png_name, dpi=150)
