"""Control of an arm, state by state; gains are one number or (n,). The laws are manyhands' (docs/control.md)."""

import logging
import math
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import control as _control
from manyhands.manipulapy.dynamics import ManipulatorDynamics

Array = NDArray[np.float64]

logger = logging.getLogger(__name__)

_TOLERANCE = 0.02


class ManipulatorController:
    """Controllers of an arm's dynamics. It remembers the integral of the error (`eint`), what adaptive control has
    learned (`parameter_estimate`), and a Kalman filter's state and uncertainty (`x_hat`, `P`); `reset` forgets them."""

    def __init__(self, dynamics: ManipulatorDynamics) -> None:
        self.dynamics = dynamics
        self.reset()

    def reset(self) -> None:
        """Forgets integral, estimates and the filter's state."""
        self.eint: Array | None = None
        self.parameter_estimate: Array | None = None
        self.x_hat: Array | None = None
        self.P: Array | None = None

    # ---- joints ------------------------------------------------------------------------------------------------

    def computed_torque_control(
        self,
        thetalistd: ArrayLike,
        dthetalistd: ArrayLike,
        ddthetalistd: ArrayLike,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        g: ArrayLike,
        dt: float,
        Kp: ArrayLike,
        Ki: ArrayLike,
        Kd: ArrayLike,
        i_clamp: float | None = None,
    ) -> Array:
        """M (Kp e + Ki eint + Kd de/dt) + inverse dynamics of the present state with the desired acceleration."""
        e, rate = self._errors(thetalistd, dthetalistd, thetalist, dthetalist)
        eint = self._integrate(e, dt, i_clamp)
        wanted = np.asarray(ddthetalistd) + np.asarray(Kp) * e + np.asarray(Ki) * eint + np.asarray(Kd) * rate
        return self.dynamics.inverse_dynamics(thetalist, dthetalist, wanted, g, np.zeros(6))

    def pid_control(
        self,
        thetalistd: ArrayLike,
        dthetalistd: ArrayLike,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        dt: float,
        Kp: ArrayLike,
        Ki: ArrayLike,
        Kd: ArrayLike,
        i_clamp: float | None = None,
    ) -> Array:
        """Kp e + Ki eint + Kd de/dt."""
        e, rate = self._errors(thetalistd, dthetalistd, thetalist, dthetalist)
        return np.asarray(Kp) * e + np.asarray(Ki) * self._integrate(e, dt, i_clamp) + np.asarray(Kd) * rate

    def pd_control(
        self,
        desired_position: ArrayLike,
        desired_velocity: ArrayLike,
        current_position: ArrayLike,
        current_velocity: ArrayLike,
        Kp: ArrayLike,
        Kd: ArrayLike,
    ) -> Array:
        """Kp e + Kd de/dt."""
        e, rate = self._errors(desired_position, desired_velocity, current_position, current_velocity)
        return np.asarray(Kp) * e + np.asarray(Kd) * rate

    def joint_space_control(
        self,
        desired_joint_angles: ArrayLike,
        current_joint_angles: ArrayLike,
        current_joint_velocities: ArrayLike,
        Kp: ArrayLike,
        Kd: ArrayLike,
    ) -> Array:
        """Kp e - Kd v."""
        v = np.asarray(current_joint_velocities, np.float64)
        return self.pd_control(desired_joint_angles, np.zeros_like(v), current_joint_angles, v, Kp, Kd)

    def feedforward_control(
        self,
        desired_position: ArrayLike,
        desired_velocity: ArrayLike,
        desired_acceleration: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
    ) -> Array:
        """Inverse dynamics of the desired motion."""
        return self.dynamics.inverse_dynamics(desired_position, desired_velocity, desired_acceleration, g, Ftip)

    def pd_feedforward_control(
        self,
        desired_position: ArrayLike,
        desired_velocity: ArrayLike,
        desired_acceleration: ArrayLike,
        current_position: ArrayLike,
        current_velocity: ArrayLike,
        Kp: ArrayLike,
        Kd: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
    ) -> Array:
        """Both together."""
        ahead = self.feedforward_control(desired_position, desired_velocity, desired_acceleration, g, Ftip)
        state = desired_position, desired_velocity, current_position, current_velocity
        return ahead + self.pd_control(*state, Kp, Kd)

    def robust_control(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        ddthetalist: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
        disturbance_estimate: ArrayLike,
        adaptation_gain: ArrayLike,
    ) -> Array:
        """Inverse dynamics, and a share of what is believed to disturb. `manyhands.control.sliding_mode` is robust."""
        tau = self.dynamics.inverse_dynamics(thetalist, dthetalist, ddthetalist, g, Ftip)
        return tau + np.asarray(adaptation_gain) * np.asarray(disturbance_estimate)

    def adaptive_control(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        ddthetalist: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
        measurement_error: ArrayLike,
        adaptation_gain: ArrayLike,
        dt: float = 1.0,
    ) -> Array:
        """Inverse dynamics, and a force that grows by adaptation_gain measurement_error dt with each call; dt 1 is what
        ManipulaPy does. `manyhands.control.Adaptive` learns inertias."""
        error = np.asarray(measurement_error, np.float64)
        if self.parameter_estimate is None or self.parameter_estimate.shape != error.shape:
            self.parameter_estimate = np.zeros_like(error)
        self.parameter_estimate = self.parameter_estimate + np.asarray(adaptation_gain) * error * dt
        tau = self.dynamics.inverse_dynamics(thetalist, dthetalist, ddthetalist, g, Ftip)
        return tau + self.parameter_estimate

    def cartesian_space_control(
        self,
        desired_position: ArrayLike,
        current_joint_angles: ArrayLike,
        current_joint_velocities: ArrayLike,
        Kp: ArrayLike,
        Kd: ArrayLike,
    ) -> Array:
        """J^T (Kp e - Kd J v) of the end effector's position (3,): gains are one number, (3,) or (3, 3)."""
        theta = np.asarray(current_joint_angles, np.float64)
        T, J = self.dynamics.forward_kinematics(theta), self.dynamics.jacobian(theta)
        p = T[:3, 3]
        linear = J[3:] - np.cross(p, J[:3].T).T  # space Jacobian: velocities at the origin of space
        e = np.asarray(desired_position, np.float64) - p
        rate = linear @ np.asarray(current_joint_velocities, np.float64)
        return linear.T @ (_times(Kp, e) - _times(Kd, rate))

    @staticmethod
    def enforce_limits(
        thetalist: ArrayLike, dthetalist: ArrayLike, tau: ArrayLike, joint_limits: Any, torque_limits: Any
    ) -> tuple[Array, Array, Array]:
        """Angles and forces within limits (n, 2), velocities as they are."""
        joints, torques = np.asarray(joint_limits, np.float64), np.asarray(torque_limits, np.float64)
        return (
            np.clip(np.asarray(thetalist, np.float64), joints[:, 0], joints[:, 1]),
            np.asarray(dthetalist, np.float64),
            np.clip(np.asarray(tau, np.float64), torques[:, 0], torques[:, 1]),
        )

    def _errors(self, *state: ArrayLike) -> tuple[Array, Array]:
        q_d, v_d, q, v = (np.asarray(x, np.float64) for x in state)
        return q_d - q, v_d - v

    def _integrate(self, e: Array, dt: float, i_clamp: float | None) -> Array:
        if i_clamp is not None and not (np.ndim(i_clamp) == 0 and math.isfinite(i_clamp) and i_clamp > 0):
            raise ValueError(f"i_clamp is {i_clamp}; expected one finite number above 0")
        if self.eint is None or np.shape(self.eint) != e.shape:
            if self.eint is not None:
                logger.debug("the arm has %s joints now: the integral begins anew", e.shape)
            self.eint = np.zeros_like(e)
        self.eint = self.eint + e * dt
        if i_clamp is not None:
            self.eint = np.clip(self.eint, -i_clamp, i_clamp)
        assert self.eint is not None
        return self.eint

    # ---- estimation --------------------------------------------------------------------------------------------

    def kalman_filter_predict(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        taulist: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
        dt: float,
        Q: ArrayLike,
    ) -> None:
        """Moves the estimate x_hat (2n,), angles and velocities, by the dynamics over dt; it begins with what is
        given."""
        if self.x_hat is None:
            self.x_hat = np.concatenate([np.asarray(thetalist, np.float64), np.asarray(dthetalist, np.float64)])
        n = len(self.x_hat) // 2
        noise = _square("Q", Q, 2 * n)
        if self.P is None:
            self.P = np.eye(2 * n)
        q, v = self.x_hat[:n], self.x_hat[n:]
        a = self.dynamics.forward_dynamics(q, v, taulist, g, Ftip)
        F = np.eye(2 * n)
        F[:n, n:] = dt * np.eye(n)
        push = np.concatenate([np.zeros(n), a * dt])
        estimate = _control.KalmanFilter(F, np.eye(2 * n), noise, np.eye(2 * n), x=self.x_hat, P=self.P)
        self.x_hat, self.P = estimate.predict(push), estimate.P

    def kalman_filter_update(self, z: ArrayLike, R: ArrayLike) -> None:
        """Takes in a measurement of angles and velocities (2n,)."""
        if self.x_hat is None or self.P is None:
            raise ValueError("there is no estimate yet: call kalman_filter_predict first")
        n = len(self.x_hat)
        measured = np.asarray(z, np.float64)
        if measured.shape != (n,):
            raise ValueError(f"z has shape {measured.shape}; expected ({n},)")
        one = np.eye(n)
        estimate = _control.KalmanFilter(one, one, 0 * one, _square("R", R, n), x=self.x_hat, P=self.P)
        self.x_hat, self.P = estimate.update(measured), estimate.P

    def kalman_filter_control(
        self,
        thetalistd: ArrayLike,
        dthetalistd: ArrayLike,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        taulist: ArrayLike,
        g: ArrayLike,
        Ftip: ArrayLike,
        dt: float,
        Q: ArrayLike,
        R: ArrayLike,
    ) -> tuple[Array, Array]:
        """Predicts and takes in the measured angles and velocities: the estimates of both, which are no forces."""
        del thetalistd, dthetalistd
        self.kalman_filter_predict(thetalist, dthetalist, taulist, g, Ftip, dt, Q)
        self.kalman_filter_update(np.concatenate([np.asarray(thetalist), np.asarray(dthetalist)]), R)
        assert self.x_hat is not None
        n = len(self.x_hat) // 2
        return self.x_hat[:n], self.x_hat[n:]

    # ---- responses ---------------------------------------------------------------------------------------------

    def calculate_rise_time(self, time: ArrayLike, response: ArrayLike, set_point: float) -> float:
        """Between the first samples at 10 % and 90 % of the set point; infinite if there are none."""
        return _control.step_response(time, response, set_point, start=0.0).rise_time

    def calculate_percent_overshoot(self, response: ArrayLike, set_point: float) -> float:
        """By how much the response goes beyond the set point, in percent of it; 0 for a set point of 0."""
        if set_point == 0:
            return 0.0
        return float((np.max(np.asarray(response, np.float64)) - set_point) / set_point * 100)

    def calculate_settling_time(
        self, time: ArrayLike, response: ArrayLike, set_point: float, tolerance: float = _TOLERANCE
    ) -> float:
        """From when on the response stays within a share of the set point; infinite if it does not."""
        return _control.step_response(time, response, set_point, start=0.0, tolerance=tolerance).settling_time

    def calculate_steady_state_error(self, response: ArrayLike, set_point: float) -> float:
        """Of the last sample."""
        return float(np.asarray(response, np.float64)[-1] - set_point)

    def plot_steady_state_response(
        self, time: ArrayLike, response: ArrayLike, set_point: float, title: str = "Steady State Response"
    ) -> None:
        """The response with what is measured of it."""
        import matplotlib.pyplot as plt

        figure, axis = plt.subplots()
        axis.plot(time, response, label="Response")
        axis.axhline(set_point, color="0.4", linestyle="--", label="Set point")
        for name, at in (
            ("Rise time", self.calculate_rise_time(time, response, set_point)),
            ("Settling time", self.calculate_settling_time(time, response, set_point)),
        ):
            if math.isfinite(at):
                axis.axvline(at, linestyle=":", label=f"{name} {at:.3g} s")
        overshoot = self.calculate_percent_overshoot(response, set_point)
        error = self.calculate_steady_state_error(response, set_point)
        axis.set(xlabel="t [s]", title=f"{title}: overshoot {overshoot:.1f} %, error {error:.3g}")
        axis.legend()
        figure.tight_layout()
        plt.show()

    # ---- tuning ------------------------------------------------------------------------------------------------

    @staticmethod
    def ziegler_nichols_tuning(Ku: ArrayLike, Tu: ArrayLike, kind: str = "PID") -> tuple[Any, Any, Any]:
        """(Kp, Ki, Kd) of the ultimate gain and period, numbers or (n,)."""
        if kind not in ("P", "PI", "PID"):
            raise ValueError(f"kind is {kind!r}; expected 'P', 'PI' or 'PID'")
        gain, period = np.asarray(Ku, np.float64), np.asarray(Tu, np.float64)
        if kind != "P" and not (np.isfinite(period) & (period > 0)).all():
            raise ValueError(f"Tu is {Tu}; expected finite numbers above 0")
        rules: dict[str, tuple[float, float, float]] = {"P": (0.5, 0, 0), "PI": (0.45, 1.2, 0), "PID": (0.6, 2, 0.125)}
        share, integral, derivative = rules[kind]
        kp = share * gain
        ki = kp * integral / period if integral else 0 * gain
        kd = kp * derivative * period if derivative else 0 * gain
        if gain.ndim == 0 and period.ndim == 0:
            return float(kp), float(ki), float(kd)
        return kp, ki, kd

    def tune_controller(
        self, Ku: ArrayLike, Tu: ArrayLike, kind: Literal["P", "PI", "PID"] = "PID"
    ) -> tuple[Any, Any, Any]:
        """The same, logged."""
        gains = self.ziegler_nichols_tuning(Ku, Tu, kind)
        logger.info("tuned %s: Kp %s, Ki %s, Kd %s", kind, *gains)
        return gains

    def find_ultimate_gain_and_period(
        self, thetalist: ArrayLike, desired_joint_angles: ArrayLike, dt: float, max_steps: int = 1000
    ) -> tuple[float, float, list[float], list[Any]]:
        """The gain of proportional control, swept up from 0.01 by a tenth, at which the arm's error grows, and the
        period with which it then swings: (gain, period, gains tried, errors over time for each)."""
        theta0, goal = np.asarray(thetalist, np.float64), np.asarray(desired_joint_angles, np.float64)
        gain, least = 0.01, math.inf
        gains: list[float] = []
        histories: list[Any] = []
        errors = np.zeros((0, len(goal)))
        while gain < 1000:
            errors = self._swing(theta0, goal, gain, dt, max_steps)
            gains.append(gain)
            histories.append(np.linalg.norm(errors, axis=1))
            if histories[-1][-1] > 1.02 * least and histories[-1][-1] >= histories[-1][0]:
                break
            least = min(least, float(histories[-1][-1]))
            gain *= 1.1
        return gains[-1], _period(errors, dt), gains, histories

    def _swing(self, theta0: Array, goal: Array, gain: float, dt: float, steps: int) -> Array:
        """Errors (k, n) of proportional control without gravity, until they run away."""
        q, v = theta0.copy(), np.zeros_like(theta0)
        errors = [goal - q]
        for _ in range(steps):
            v = v + dt * self.dynamics.forward_dynamics(q, v, gain * (goal - q), (0.0, 0.0, 0.0))
            q = q + dt * v
            errors.append(goal - q)
            if not np.isfinite(q).all() or np.abs(q).max() > 1e3:
                break
        return np.array(errors)


def _period(errors: Array, dt: float) -> float:
    """Of the joint that swings most: twice the mean time between zeros; the whole time if there are less than two."""
    most = errors[:, np.argmax(np.ptp(errors, axis=0))]
    zeros = np.flatnonzero(np.diff(np.sign(most)) != 0)
    return float(2 * dt * np.diff(zeros).mean()) if len(zeros) > 1 else float(len(most) * dt)


def _times(gain: ArrayLike, x: Array) -> Array:
    K = np.asarray(gain, np.float64)
    return K @ x if K.ndim == 2 else K * x


def _square(name: str, values: ArrayLike, n: int) -> Array:
    array = np.asarray(values, np.float64)
    if array.shape != (n, n):
        raise ValueError(f"{name} has shape {array.shape}; expected ({n}, {n})")
    return array
