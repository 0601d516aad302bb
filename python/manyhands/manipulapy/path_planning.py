"""Trajectories of joints and of a frame, dynamics along them, and paths past obstacles."""

import logging
import time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands import kinematics, planning
from manyhands.manipulapy.dynamics import ManipulatorDynamics
from manyhands.manipulapy.ik_helpers import limit_array
from manyhands.manipulapy.kinematics import SerialManipulator
from manyhands.manipulapy.potential_field import CollisionChecker, PotentialField

Array = NDArray[np.float32]
Rows = NDArray[np.float64]

logger = logging.getLogger(__name__)

_STEP, _MOST_STEPS = 0.01, 10
_ROUGH = 0.01  # how far a matrix may be from a rotation


class TrajectoryPlanning:
    """Plans for an arm. joint_limits (n, 2); torque_limits (n, 2), none by default."""

    def __init__(
        self,
        serial_manipulator: SerialManipulator,
        urdf_path: str,
        dynamics: ManipulatorDynamics,
        joint_limits: Any,
        torque_limits: Any = None,
        *,
        use_cuda: bool | None = None,
        cuda_threshold: int = 10,
        memory_pool_size_mb: int | None = None,
        enable_profiling: bool = False,
        auto_optimize: bool = True,
        kernel_type: str = "auto",
        target_speedup: float = 40.0,
    ) -> None:
        del cuda_threshold, memory_pool_size_mb, enable_profiling, auto_optimize, kernel_type, target_speedup
        if use_cuda:
            raise RuntimeError("there are no CUDA kernels here: trajectories are computed in C++ on the processor")
        self.serial_manipulator, self.dynamics, self.urdf_path = serial_manipulator, dynamics, urdf_path
        self.joint_limits = limit_array(joint_limits, np.inf).astype(np.float32)
        unlimited = np.full(self.joint_limits.shape, np.inf) * [-1, 1]
        self.torque_limits = np.asarray(unlimited if torque_limits is None else torque_limits, np.float32)
        self.collision_checker: CollisionChecker | None = None
        self.potential_field: PotentialField | None = None
        self.reset_performance_stats()
        try:
            self.collision_checker, self.potential_field = CollisionChecker(urdf_path), PotentialField()
        except Exception as reason:  # a path that is no robot: trajectories do without
            logger.warning("no collisions are looked at: %s", reason)

    # ---- trajectories ------------------------------------------------------------------------------------------

    def joint_trajectory(
        self,
        thetastart: ArrayLike,
        thetaend: ArrayLike,
        Tf: float,
        N: int,
        method: int,
        kernel_type: str | None = None,
        enable_monitoring: bool | None = None,
    ) -> dict[str, Array]:
        """{"positions", "velocities", "accelerations"}, (N, n) float32 each, at N even times from 0 to Tf [s]: from
        rest to rest, with method 3 as a cubic and 5 as a quintic polynomial. Positions stay within the limits; where
        they are held there, nothing moves. Raises ValueError on another method."""
        del kernel_type, enable_monitoring
        start, end = (np.atleast_1d(np.asarray(x, np.float64)) for x in (thetastart, thetaend))
        if start.shape != end.shape or start.ndim != 1:
            raise ValueError(f"the start has shape {start.shape} and the end {end.shape}; expected (n,) both")
        begin = time.perf_counter()
        sampled = _law(Tf, method, np.stack([start, end])).sample(_times(Tf, N))
        self._count(begin)
        return self._within(sampled)

    def batch_joint_trajectory(
        self,
        thetastart_batch: ArrayLike,
        thetaend_batch: ArrayLike,
        Tf: float,
        N: int,
        method: int,
        kernel_type: str | None = None,
    ) -> dict[str, Array]:
        """The same of B starts and ends (B, n): (B, N, n) each."""
        del kernel_type
        start, end = (np.asarray(x, np.float64) for x in (thetastart_batch, thetaend_batch))
        if start.ndim != 2 or start.shape != end.shape:
            raise ValueError(f"the starts have shape {start.shape} and the ends {end.shape}; expected (B, n) both")
        begin = time.perf_counter()
        flat = _law(Tf, method, np.stack([start.ravel(), end.ravel()])).sample(_times(Tf, N))
        B, n = start.shape
        self._count(begin)
        return self._within(planning.Sample(*(x.reshape(N, B, n).swapaxes(0, 1) for x in flat)))

    def _within(self, sampled: planning.Sample) -> dict[str, Array]:
        if len(self.joint_limits) != sampled.q.shape[-1]:
            raise ValueError(
                f"there are {sampled.q.shape[-1]} joints; the planner has limits of {len(self.joint_limits)}"
            )
        positions = np.clip(sampled.q, self.joint_limits[:, 0], self.joint_limits[:, 1])
        held = positions != sampled.q
        return {
            "positions": positions.astype(np.float32),
            "velocities": np.where(held, 0.0, sampled.v).astype(np.float32),
            "accelerations": np.where(held, 0.0, sampled.a).astype(np.float32),
        }

    def cartesian_trajectory(
        self, Xstart: ArrayLike, Xend: ArrayLike, Tf: float, N: int, method: int
    ) -> dict[str, Array]:
        """{"positions", "velocities", "accelerations"} (N, 3) of the origin on a straight line, and "orientations"
        (N, 3, 3), which turn evenly about one axis."""
        position, quaternion = kinematics.pose(np.stack([_rigid(Xstart), _rigid(Xend)]))
        law = _law(Tf, method, np.array([[0.0], [1.0]]))
        found = planning.cartesian(position, quaternion, law).sample(_times(Tf, N))
        return {
            "positions": found.position.astype(np.float32),
            "velocities": found.velocity[:, 3:].astype(np.float32),
            "accelerations": found.acceleration[:, 3:].astype(np.float32),
            "orientations": kinematics.matrix(found.position, found.quaternion)[:, :3, :3].astype(np.float32),
        }

    def calculate_derivatives(self, positions: ArrayLike, dt: float) -> tuple[Rows, Rows, Rows]:
        """Velocity, acceleration and jerk by forward differences: N - 1, N - 2 and N - 3 rows."""
        velocity = np.diff(np.asarray(positions, np.float64), axis=0) / dt
        acceleration = np.diff(velocity, axis=0) / dt
        return velocity, acceleration, np.diff(acceleration, axis=0) / dt

    # ---- dynamics along them -----------------------------------------------------------------------------------

    def inverse_dynamics_trajectory(
        self,
        thetalist_trajectory: ArrayLike,
        dthetalist_trajectory: ArrayLike,
        ddthetalist_trajectory: ArrayLike,
        gravity_vector: ArrayLike | None = None,
        Ftip: ArrayLike | None = None,
    ) -> Array:
        """Joint forces (N, n) float32 within the limits, of N states."""
        given = (thetalist_trajectory, dthetalist_trajectory, ddthetalist_trajectory)
        q, v, a = (np.asarray(x, np.float64) for x in given)
        tau = self.dynamics.inverse_dynamics(q, v, a, gravity_vector, Ftip)
        return np.clip(tau, self.torque_limits[:, 0], self.torque_limits[:, 1]).astype(np.float32)

    def forward_dynamics_trajectory(
        self,
        thetalist: ArrayLike,
        dthetalist: ArrayLike,
        taumat: ArrayLike,
        g: ArrayLike,
        Ftipmat: ArrayLike,
        dt: float,
        intRes: int,
    ) -> dict[str, Array]:
        """{"positions", "velocities", "accelerations"} (N, n) float32 of the arm under joint forces taumat (N, n), one
        for each dt [s], in intRes steps each. Row 0 is the start. A joint that reaches its limit stops there."""
        tau, pushes = np.asarray(taumat, np.float64), np.asarray(Ftipmat, np.float64)
        if len(tau) == 0:
            raise ValueError("taumat is empty; expected one row or more")
        q, v = np.array(thetalist, np.float64), np.array(dthetalist, np.float64)
        low, high = self.joint_limits.T
        h, rows = dt / intRes, []
        for k in range(len(tau)):
            a = self.dynamics.forward_dynamics(q, v, tau[k], g, pushes[k])
            rows.append((q, v, a))
            for _ in range(intRes):
                v = v + h * self.dynamics.forward_dynamics(q, v, tau[k], g, pushes[k])
                ahead = q + h * v
                q = np.clip(ahead, low, high)
                v = np.where(q != ahead, 0.0, v)
        names = ("positions", "velocities", "accelerations")
        return {name: np.array(x, np.float32) for name, x in zip(names, zip(*rows, strict=True), strict=True)}

    # ---- past obstacles ----------------------------------------------------------------------------------------

    def plan_trajectory(
        self, start_position: ArrayLike, target_position: ArrayLike, obstacle_points: Any
    ) -> list[list[float]]:
        """Six joint positions on a straight line, those between the ends pushed off obstacles (m, n), which are points
        of the space of joints, by up to ten steps of 0.01 down the potential field."""
        start, target = np.asarray(start_position, np.float64), np.asarray(target_position, np.float64)
        path = np.linspace(start, target, 6)
        obstacles = np.asarray([] if obstacle_points is None else obstacle_points, np.float64)
        if obstacles.size:
            field = self.potential_field or PotentialField()
            obstacles = obstacles.reshape(-1, obstacles.shape[-1])[:, : len(start)]
            for point in path[1:-1]:
                for _ in range(_MOST_STEPS):
                    if field.compute_repulsive_potential(point, obstacles) == 0:
                        break
                    slope = field.compute_gradient(point, target, obstacles)
                    point -= _STEP * slope / max(1.0, float(np.linalg.norm(slope)))
        return [[float(x) for x in point] for point in path]

    # ---- pictures ----------------------------------------------------------------------------------------------

    @staticmethod
    def plot_trajectory(
        trajectory_data: dict[str, ArrayLike],
        Tf: float,
        title: str = "Joint Trajectory",
        labels: list[str] | None = None,
        performance_stats: Any = None,
    ) -> None:
        """Positions, velocities and accelerations of every joint."""
        del performance_stats
        names = ("positions", "velocities", "accelerations")
        rows = [np.asarray(trajectory_data[name]) for name in names]
        titles = labels or [f"Joint {k + 1}" for k in range(rows[0].shape[1])]
        _plot(rows, np.linspace(0, Tf, len(rows[0])), [name.capitalize() for name in names], titles, title)

    def plot_tcp_trajectory(self, trajectory: ArrayLike, dt: float) -> None:
        """Position, velocity, acceleration and jerk of the end effector along joint positions (N, n)."""
        position = self.serial_manipulator.forward_kinematics(np.asarray(trajectory, np.float64))[:, :3, 3]
        rows = [position, *self.calculate_derivatives(position, dt)]
        names = ["Position", "Velocity", "Acceleration", "Jerk"]
        _plot(rows, np.arange(len(position)) * dt, names, ["x", "y", "z"], "End effector")

    def plot_cartesian_trajectory(
        self, trajectory_data: dict[str, ArrayLike], Tf: float, title: str = "Cartesian Trajectory"
    ) -> None:
        """Position, velocity and acceleration over time."""
        names = ("positions", "velocities", "accelerations")
        rows = [np.asarray(trajectory_data[name]) for name in names]
        _plot(rows, np.linspace(0, Tf, len(rows[0])), [name.capitalize() for name in names], ["x", "y", "z"], title)

    def plot_ee_trajectory(
        self, trajectory_data: dict[str, ArrayLike], Tf: float, title: str = "End-Effector Trajectory"
    ) -> None:
        """The path in space."""
        import matplotlib.pyplot as plt

        del Tf
        position = np.asarray(trajectory_data["positions"], np.float64)
        if position.shape[1] != 3:
            position = self.serial_manipulator.forward_kinematics(position)[:, :3, 3]
        ax = plt.figure().add_subplot(projection="3d")
        ax.plot(*position.T, label="End-Effector Trajectory")
        ax.set(xlabel="X", ylabel="Y", zlabel="Z", title=title)
        ax.legend()
        plt.show()

    # ---- what it cost ------------------------------------------------------------------------------------------

    def _count(self, begin: float) -> None:
        self.performance_stats["cpu_calls"] += 1
        self.performance_stats["total_cpu_time"] += time.perf_counter() - begin

    def get_performance_stats(self) -> dict[str, Any]:
        """Calls and seconds."""
        stats = dict(self.performance_stats)
        calls = stats["cpu_calls"]
        stats["avg_cpu_time"] = stats["total_cpu_time"] / calls if calls else 0.0
        stats["avg_gpu_time"] = stats["gpu_usage_percent"] = 0.0
        return stats

    def reset_performance_stats(self) -> None:
        self.performance_stats: dict[str, Any] = {
            "gpu_calls": 0,
            "cpu_calls": 0,
            "total_gpu_time": 0.0,
            "total_cpu_time": 0.0,
            "memory_transfers": 0,
            "kernel_launches": 0,
            "speedup_achieved": 0.0,
            "best_kernel_used": "none",
        }

    def cleanup_gpu_memory(self) -> None:
        """There is none to clean up."""


OptimizedTrajectoryPlanning = TrajectoryPlanning


def create_optimized_planner(
    serial_manipulator: SerialManipulator,
    urdf_path: str,
    dynamics: ManipulatorDynamics,
    joint_limits: Any,
    torque_limits: Any = None,
    **options: Any,
) -> TrajectoryPlanning:
    """`TrajectoryPlanning` by another name."""
    options.pop("gpu_memory_mb", None)
    return TrajectoryPlanning(serial_manipulator, urdf_path, dynamics, joint_limits, torque_limits, **options)


def compare_implementations(
    serial_manipulator: SerialManipulator,
    urdf_path: str,
    dynamics: ManipulatorDynamics,
    joint_limits: Any,
    test_params: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Times a trajectory of N points; there is one implementation, so the speedup is 1."""
    planner = TrajectoryPlanning(serial_manipulator, urdf_path, dynamics, joint_limits)
    n = len(planner.joint_limits)
    given = {"thetastart": np.zeros(n), "thetaend": np.full(n, 0.5), "Tf": 2.0, "N": 1000, "method": 5}
    begin = time.perf_counter()
    found = planner.joint_trajectory(**{**given, **(test_params or {})})
    seconds = time.perf_counter() - begin
    return {"cpu": {"time": seconds, "result": found, "stats": planner.get_performance_stats()}, "speedup": 1.0}


def _rigid(T: ArrayLike) -> Rows:
    """A pose (4, 4) whose rotation is one to the last digit; programs write them with fewer."""
    pose = np.array(T, np.float64)
    u, _, vt = np.linalg.svd(pose[:3, :3])
    if np.abs(u @ vt - pose[:3, :3]).max() < _ROUGH:
        pose[:3, :3] = u @ vt
    return pose


def _times(Tf: float, N: int) -> Rows:
    if N < 1:
        raise ValueError(f"N is {N}; expected 1 or more")
    return np.linspace(0.0, Tf, N) if N > 1 else np.zeros(1)


def _law(Tf: float, method: int, ends: Rows) -> planning.Trajectory:
    if not (np.isfinite(Tf) and Tf > 0):
        raise ValueError(f"Tf is {Tf}; expected a time above 0")
    rest = np.zeros_like(ends)
    if method == 3:
        return planning.cubic([0.0, Tf], ends, rest)
    if method == 5:
        return planning.quintic([0.0, Tf], ends, rest, rest)
    raise ValueError(f"method is {method}; expected 3 for a cubic or 5 for a quintic polynomial")


def _plot(rows: list[Any], t: Any, names: list[str], columns: list[str], title: str) -> None:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        len(rows), len(columns), figsize=(3 * len(columns), 2 * len(rows)), sharex=True, squeeze=False
    )
    figure.suptitle(title)
    for i, (name, values) in enumerate(zip(names, rows, strict=True)):
        for k, column in enumerate(columns):
            axes[i, k].plot(t[: len(values)], values[:, k])
            axes[i, k].grid(alpha=0.3)
            if i == 0:
                axes[i, k].set_title(column)
        axes[i, 0].set_ylabel(name)
    plt.show()
