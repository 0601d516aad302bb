"""Dynamics of a serial arm: exact, by recursive algorithms in C++."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import dynamics as _dynamics
from manyhands._core import Model
from manyhands.manipulapy.kinematics import SerialManipulator
from manyhands.manipulapy.serial_model import serial_model

Array = NDArray[np.float64]

_GRAVITY = (0.0, 0.0, -9.81)
_MOST_MODELS = 8


class ManipulatorDynamics(SerialManipulator):
    """An arm with the spatial inertias Glist (n, 6, 6) of its links, angular first, each about the link's centre of
    mass, whose poses (4, 4) at angles 0 are Mlist_per_link. Without these a link's inertia counts as about a point on
    its joint's axis, and a warning says so."""

    def __init__(
        self,
        M_list: ArrayLike,
        omega_list: ArrayLike,
        r_list: ArrayLike | None,
        b_list: ArrayLike | None,
        S_list: ArrayLike | None,
        B_list: ArrayLike | None,
        Glist: Sequence[ArrayLike] | NDArray[np.float64],
        Mlist_per_link: Sequence[ArrayLike] | NDArray[np.float64] | None = None,
    ) -> None:
        super().__init__(M_list, omega_list, r_list, b_list, S_list, B_list, Glist)
        self.Glist = [np.asarray(G, np.float64) for G in Glist]
        self.Mlist_per_link = None if Mlist_per_link is None else [np.asarray(M, np.float64) for M in Mlist_per_link]
        if self.Mlist_per_link is None:
            warnings.warn(
                "without Mlist_per_link nobody knows where the links' centres of mass are; "
                "their inertias count as about the joints",
                UserWarning,
                stacklevel=2,
            )
        self._models: dict[tuple[float, ...], Model] = {}

    def _under(self, g: ArrayLike | None) -> Model:
        """The model under a gravity (3,)."""
        gravity = _GRAVITY if g is None else tuple(np.asarray(g, np.float64).ravel().tolist())
        model = self._models.get(gravity)
        if model is None:
            if len(gravity) != 3:
                raise ValueError(f"gravity has {len(gravity)} numbers; expected 3")
            if len(self._models) >= _MOST_MODELS:
                self._models.clear()
            model = serial_model(self.M_list, self.S_list, self.Glist, self.Mlist_per_link, gravity=np.array(gravity))
            self._models[gravity] = model
        return model

    def mass_matrix(self, thetalist: ArrayLike) -> Array:
        """M (n, n), symmetric."""
        return _dynamics.crba(self._under(None), np.asarray(thetalist, np.float64))

    def partial_derivative(self, i: int, j: int, k: int, thetalist: ArrayLike) -> float:
        """dM_ij / dtheta_k, by central differences."""
        step = np.zeros(self.S_list.shape[1])
        step[k] = 1e-6
        theta = np.asarray(thetalist, np.float64)
        return float((self.mass_matrix(theta + step) - self.mass_matrix(theta - step))[i, j] / 2e-6)

    def velocity_quadratic_forces(self, thetalist: ArrayLike, dthetalist: ArrayLike) -> Array:
        """Coriolis and centrifugal forces (n,)."""
        theta, rate = np.asarray(thetalist, np.float64), np.asarray(dthetalist, np.float64)
        return _dynamics.rnea(self._under((0.0, 0.0, 0.0)), theta, rate, np.zeros_like(rate))

    def gravity_forces(self, thetalist: ArrayLike, g: ArrayLike | None = None) -> Array:
        """Joint forces (n,) that hold the arm at rest."""
        theta = np.asarray(thetalist, np.float64)
        return _dynamics.rnea(self._under(g), theta, np.zeros_like(theta), np.zeros_like(theta))

    def inverse_dynamics(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        ddthetalist: ArrayLike,
        g: ArrayLike | None = None,
        Ftip: ArrayLike | None = None,
    ) -> Array:
        """Joint forces (n,) for accelerations (n,), while the arm pushes the world with Ftip (6,): moment and force in
        the space frame."""
        theta = np.asarray(thetalist, np.float64)
        return _dynamics.rnea(self._under(g), theta, dthetalist, ddthetalist) + self._push(theta, Ftip)

    def forward_dynamics(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        taulist: ArrayLike,
        g: ArrayLike | None = None,
        Ftip: ArrayLike | None = None,
    ) -> Array:
        """Accelerations (n,) under joint forces (n,)."""
        theta = np.asarray(thetalist, np.float64)
        tau = np.asarray(taulist, np.float64) - self._push(theta, Ftip)
        return _dynamics.aba(self._under(g), theta, dthetalist, tau)

    def _push(self, theta: Array, Ftip: ArrayLike | None) -> Any:
        if Ftip is None:
            return 0.0
        F = np.asarray(Ftip, np.float64)
        return np.einsum("...ij,...i->...j", self.jacobian(theta), F) if F.any() else 0.0
