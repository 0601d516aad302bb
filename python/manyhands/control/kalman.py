"""State estimation."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import control as _control
from manyhands.arguments import bounded, finite_rows, number, together

_core: Any = _control  # its rows are unpacked, which overloads do not take

Array = NDArray[np.float64]


class KalmanFilter:
    """The state x (..., k) of a linear system and its uncertainty, from how it moves and what is measured (Kalman,
    1960).

    F: (k, k), x moves to F x. H: (m, k), H x is measured. Q: (k, k) covariance of what else moves it in a step; R: (m,
    m) of the measurements' noise. x: (..., k) and P: (k, k) to begin with.
    """

    def __init__(
        self, F: ArrayLike, H: ArrayLike, Q: ArrayLike, R: ArrayLike, *, x: ArrayLike, P: ArrayLike | None = None
    ) -> None:
        self.x, measured = finite_rows("x", x), finite_rows("H", H)
        if self.x.ndim == 0:
            raise ValueError("x has shape (); expected (..., k)")
        k, m = self.x.shape[-1], measured.shape[0] if measured.ndim == 2 else 0
        self.F, self.H = _matrix("F", F, k, k), _matrix("H", H, m, k)
        self.Q, self.R = _covariance("Q", Q, k), _covariance("R", R, m)
        begin = np.eye(k) if P is None else _covariance("P", P, k)
        self.P: Array = np.broadcast_to(begin, (*self.x.shape[:-1], k, k))

    @classmethod
    def of_joints(
        cls, q: ArrayLike, *, dt: float, acceleration_noise: ArrayLike, position_noise: ArrayLike
    ) -> "KalmanFilter":
        """Of positions and velocities, x = (q, v), of joints whose positions q (..., nq) are measured every dt [s].

        acceleration_noise: standard deviation of what a model does not know [rad/s² or m/s²]; position_noise: of a
        measurement [rad or m]; one number of 0 or more, or (nq,), each. Give `predict` the accelerations that a model
        says, times (dt²/2, dt).
        """
        measured, h = finite_rows("q", q), number("dt", dt, above=0)
        if measured.ndim == 0 or measured.shape[-1] == 0:
            raise ValueError(f"q has shape {measured.shape}; expected (..., nq)")
        n = measured.shape[-1]
        a, noise = (
            bounded(name, given, n, least=0)
            for name, given in (("acceleration_noise", acceleration_noise), ("position_noise", position_noise))
        )
        one, none = np.eye(n), np.zeros((n, n))
        push = np.vstack([h * h / 2 * one, h * one]) * a
        return cls(
            np.block([[one, h * one], [none, one]]),
            np.hstack([one, none]),
            push @ push.T,
            np.diag(noise**2),
            x=np.concatenate([measured, np.zeros_like(measured)], axis=-1),
        )

    def predict(self, push: ArrayLike = 0.0) -> Array:
        """x := F x + push (..., k), and P with it."""
        self.x = np.add(*together(x=self.x @ self.F.T, push=finite_rows("push", push)))
        k = self.x.shape[-1]
        P = np.ascontiguousarray(self.P.reshape(-1, k, k))
        self.P = _core.kalman_predict(self.F, self.Q, P).reshape(self.P.shape)
        return self.x

    def update(self, z: ArrayLike) -> Array:
        """Takes in a measurement z (..., m), and returns x."""
        k, m = self.x.shape[-1], self.H.shape[0]
        measured = np.broadcast_to(finite_rows("z", z, m), (*self.x.shape[:-1], m)).reshape(-1, m)
        x, P = _core.kalman_update(self.H, self.R, measured, self.x.reshape(-1, k), self.P.reshape(-1, k, k))
        self.x, self.P = x.reshape(self.x.shape), P.reshape(self.P.shape)
        return self.x


def _matrix(name: str, values: ArrayLike, *shape: int) -> Array:
    array = finite_rows(name, values)
    if array.shape != shape or 0 in shape:
        raise ValueError(f"{name} has shape {array.shape}; expected {shape}")
    return np.ascontiguousarray(array)


def _covariance(name: str, values: ArrayLike, size: int) -> Array:
    array = _matrix(name, values, size, size)
    if not np.allclose(array, array.T) or np.linalg.eigvalsh(array).min() < -1e-12 * max(1.0, np.abs(array).max()):
        raise ValueError(f"{name} must be symmetric and not negative, as a covariance is")
    return array
