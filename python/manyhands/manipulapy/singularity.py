"""Where an arm loses directions, and where it can reach."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.manipulapy.ik_helpers import limit_array
from manyhands.manipulapy.kinematics import SerialManipulator

Array = NDArray[np.float64]

_SINGULAR = 1e-4
_SEED = 1234


class Singularity:
    """Of a serial manipulator."""

    def __init__(self, serial_manipulator: SerialManipulator) -> None:
        self.serial_manipulator = serial_manipulator

    def _lengths(self, thetalist: ArrayLike) -> Array:
        return np.asarray(np.linalg.svd(self.serial_manipulator.jacobian(thetalist), compute_uv=False), np.float64)

    def singularity_analysis(self, thetalist: ArrayLike) -> bool:
        """Whether the smallest singular value of the Jacobian is below 1e-4."""
        return bool(self._lengths(thetalist)[-1] < _SINGULAR)

    def condition_number(self, thetalist: ArrayLike) -> np.float64:
        """The largest singular value over the smallest; infinite where a direction is lost."""
        lengths = self._lengths(thetalist)
        lost = lengths[-1] <= np.finfo(float).eps * max(6, len(lengths)) * lengths[0]
        return np.float64(np.inf) if lost else lengths[0] / lengths[-1]

    def near_singularity_detection(self, thetalist: ArrayLike, threshold: float = 1e-2) -> np.bool_:
        """A threshold below 1 is of the smallest singular value over the largest, one of 1 or more of its inverse."""
        condition = self.condition_number(thetalist)
        return condition > threshold if threshold >= 1 else 1 / condition < threshold

    def manipulability_ellipsoid(self, thetalist: ArrayLike, ax: Any = None) -> Any:
        """Draws where a unit of joint velocity takes the end effector, linear and angular; returns the Matplotlib
        axes."""
        import matplotlib.pyplot as plt

        shows = ax is None
        if ax is None:
            ax = plt.figure().add_subplot(projection="3d")
        theta = np.asarray(thetalist, np.float64)
        T, J = self.serial_manipulator.forward_kinematics(theta), self.serial_manipulator.jacobian(theta)
        linear = J[3:] - np.cross(T[:3, 3], J[:3].T).T  # of the end effector's origin
        for rows, colour, name in ((linear, "b", "Linear velocity"), (J[:3], "r", "Angular velocity")):
            self._draw(ax, rows, colour, name)
        ax.set(xlabel="x", ylabel="y", zlabel="z", title="Manipulability")
        if shows:
            plt.show()
        return ax

    @staticmethod
    def _draw(ax: Any, rows: Array, colour: str, name: str) -> None:
        axes, lengths, _ = np.linalg.svd(rows)
        u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 40), np.linspace(0, np.pi, 20))
        ball = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
        x, y, z = np.einsum("ij,jkl->ikl", axes * lengths, ball)
        ax.plot_surface(x, y, z, color=colour, alpha=0.4, label=name)

    def plot_workspace_monte_carlo(self, joint_limits: Any, num_samples: int = 10000) -> Array:
        """Draws where the end effector is at random angles, and returns the positions (num_samples, 3)."""
        import matplotlib.pyplot as plt

        bounds = limit_array(joint_limits, np.pi)
        theta = np.random.default_rng(_SEED).uniform(bounds[:, 0], bounds[:, 1], (num_samples, len(bounds)))
        positions = self.serial_manipulator.forward_kinematics(theta)[:, :3, 3]
        ax = plt.figure().add_subplot(projection="3d")
        ax.scatter(*positions.T, s=1, alpha=0.3)
        ax.set(xlabel="x", ylabel="y", zlabel="z", title="Workspace")
        plt.show()
        return positions
