"""A manipulator in a world: trajectories played, followed, and led by sliders; on manyhands' PyBullet module."""

import contextlib
import logging
import math
import os
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import manyhands.pybullet as p
import manyhands.pybullet_data as pybullet_data
from manyhands.files import replacing
from manyhands.manipulapy.control import ManipulatorController
from manyhands.manipulapy.dynamics import ManipulatorDynamics
from manyhands.manipulapy.kinematics import SerialManipulator
from manyhands.manipulapy.path_planning import TrajectoryPlanning
from manyhands.manipulapy.sim.sliders import Sliders
from manyhands.manipulapy.sim.trail import draw_trail
from manyhands.manipulapy.urdf import URDF
from manyhands.manipulapy.urdf_processor import URDFToSerialManipulator

Array = NDArray[np.float64]
Place = tuple[float, float, float]

__all__ = ["Simulation"]

CONNECT = "MANIPULAPY_PYBULLET_CONNECT"
"""The environment variable that says how to connect: "DIRECT" or "GUI"."""

_STRONG = 1000.0  # a motor without torque limits [N m or N]
_GRAVITY = -9.81
_WAIT = 0.01  # between looks for the reset button [s]


_open: dict[int, list[int]] = {}
"""The clients of simulations that are open, the newest last, and the floor and robot in each."""


def newest_client() -> int:
    """The client of the newest simulation that is open, else 0."""
    return next(reversed(_open), 0)


def scenery(client: int) -> list[int]:
    """The bodies of a client that its simulation has loaded: floor and robot."""
    return _open.get(client, [])


class RobotFileError(FileNotFoundError, p.error):
    """There is no such file: what Python and the engine raise, in one."""


class Simulation:
    """A robot, fixed to the floor, in a world of its own.

    urdf_file_path: of the robot. joint_limits: (low, high) of every joint that moves; torque_limits: likewise, or one
    number each. time_step [s]. real_time_factor: how much faster than the clock on the wall it plays; 0, None or
    infinity is as fast as it can. physics_client: a client that is there already, which is reset and never
    disconnected. enable_self_collision; disable_pairs: pairs of links that then do not touch each other, the base
    included.

    Raises FileNotFoundError, which is a p.error too, for a file that is not there, and ValueError on limits that do not
    fit the joints and on a time step that is not above 0.
    """

    def __init__(
        self,
        urdf_file_path: str,
        joint_limits: Sequence[tuple[float, float]],
        torque_limits: Sequence[Any] | None = None,
        time_step: float = 0.01,
        real_time_factor: float | None = 1.0,
        physics_client: int | None = None,
        enable_self_collision: bool = False,
        disable_pairs: Sequence[tuple[str, str]] | None = None,
    ) -> None:
        if not (math.isfinite(time_step) and time_step > 0):
            raise ValueError(f"time_step is {time_step}; expected seconds above 0")
        self.urdf_file_path, self.joint_limits, self.torque_limits = str(urdf_file_path), joint_limits, torque_limits
        self.time_step, self.real_time_factor = time_step, real_time_factor
        self.enable_self_collision, self.disable_pairs = enable_self_collision, disable_pairs
        self.logger = self.setup_logger()
        self.physics_client = physics_client
        self._owns_client = physics_client is None
        self.robot: SerialManipulator | None = None
        self.dynamics: ManipulatorDynamics | None = None
        self.trajectory_planner: TrajectoryPlanning | None = None
        self.controller: ManipulatorController | None = None
        self.joint_params: list[int] = []
        self.reset_button: int | None = None
        self.gravity_param: int | None = None
        self.time_step_param: int | None = None
        self.home_position: Array | None = None
        self.trajectory_body_ids: list[int] = []
        self.plane_id: int | None = None
        self.robot_id: int | None = None
        self.non_fixed_joints: list[int] = []
        self.setup_simulation()

    # ---- the world ---------------------------------------------------------------------------------------------

    def setup_logger(self) -> logging.Logger:
        """The logger "SimulationLogger", with one handler however often it is asked for."""
        logger = logging.getLogger("SimulationLogger")
        logger.setLevel(logging.DEBUG)
        logger.propagate = False
        if not any(type(handler) is logging.StreamHandler for handler in logger.handlers):
            handler = logging.StreamHandler()
            handler.setFormatter(logging.Formatter("%(asctime)s - %(name)s - %(levelname)s - %(message)s"))
            logger.addHandler(handler)
        return logger

    def setup_simulation(self) -> None:
        """Connects if need be, and builds the scene anew: floor and robot, nothing else."""
        if self.physics_client is None:
            self.physics_client, self._owns_client = self._connect(), True
        client = self.client
        p.resetSimulation(physicsClientId=client)
        p.setAdditionalSearchPath(pybullet_data.getDataPath(), physicsClientId=client)
        p.setGravity(0, 0, _GRAVITY, physicsClientId=client)
        p.setTimeStep(self.time_step, physicsClientId=client)
        self._sliders = Sliders(client)
        self.joint_params, self.reset_button, self.trajectory_body_ids = [], None, []
        self.gravity_param = self.time_step_param = None
        self.plane_id = p.loadURDF("plane.urdf", physicsClientId=client)
        self.robot_id = self._load_robot()
        _open[client] = [body for body in (self.plane_id, self.robot_id) if body is not None]
        self._look_at_joints()

    def connect_simulation(self) -> None:
        """Connects if need be, and builds the scene anew."""
        self.logger.info("connecting the simulation")
        self.setup_simulation()

    def disconnect_simulation(self) -> None:
        """Leaves the client; one that was given stays connected."""
        self.logger.info("disconnecting the simulation")
        _open.pop(-1 if self.physics_client is None else self.physics_client, None)
        if self.physics_client is not None and self._owns_client:
            with contextlib.suppress(p.error):  # somebody else has disconnected it
                p.disconnect(physicsClientId=self.physics_client)
        self.physics_client = None

    def close_simulation(self) -> None:
        """Clears the trail and disconnects; harmless when it is closed already."""
        self.logger.info("closing the simulation")
        self.clear_trajectory_visualization()
        self.disconnect_simulation()

    def _connect(self) -> int:
        mode = os.environ.get(CONNECT, "").strip().upper()
        if mode == "DIRECT":
            return p.connect(p.DIRECT)
        if mode == "GUI":
            return p.connect(p.GUI)
        try:
            return p.connect(p.GUI)
        except p.error as reason:
            self.logger.warning("no window (%s): the simulation is headless", reason)
            return p.connect(p.DIRECT)

    @property
    def client(self) -> int:
        """The client. Raises RuntimeError when the simulation is closed."""
        if self.physics_client is None:
            raise RuntimeError("the simulation is closed; call connect_simulation() or make another one")
        return self.physics_client

    def _load_robot(self) -> int:
        flags = p.URDF_USE_SELF_COLLISION if self.enable_self_collision else 0
        try:
            return p.loadURDF(self.urdf_file_path, useFixedBase=True, flags=flags, physicsClientId=self.client)
        except p.error as reason:
            if not Path(self.urdf_file_path).is_file():
                raise RobotFileError(f"there is no robot file {self.urdf_file_path!r}: {reason}") from reason
            raise

    def _look_at_joints(self) -> None:
        infos = [p.getJointInfo(self.robot_id, k, physicsClientId=self.client) for k in range(self._num_joints())]
        self.non_fixed_joints = [info[0] for info in infos if info[2] != p.JOINT_FIXED]
        self._links = {info[12].decode(): info[0] for info in infos}
        self._links.setdefault(p.getBodyInfo(self.robot_id, physicsClientId=self.client)[0].decode(), -1)
        self.home_position = np.zeros(len(self.non_fixed_joints))
        self._tip = self._links.get(self._tip_name(), len(infos) - 1)
        if len(self.joint_limits) != len(self.non_fixed_joints):
            raise ValueError(
                f"there are {len(self.joint_limits)} joint limits; "
                f"the robot has {len(self.non_fixed_joints)} joints that move"
            )
        if self.enable_self_collision:
            self._disable_pairs()

    def _num_joints(self) -> int:
        return p.getNumJoints(self.robot_id, physicsClientId=self.client)

    def _tip_name(self) -> str:
        """The end effector, the same as that of `initialize_robot`."""
        try:
            return URDF.load(self.urdf_file_path).end_effector_link
        except (ValueError, FileNotFoundError):  # found by the search path, or no plain tree
            return ""

    def _disable_pairs(self) -> None:
        for first, second in self.disable_pairs or ():
            if first in self._links and second in self._links:
                links = self._links[first], self._links[second]
                p.setCollisionFilterPair(self.robot_id, self.robot_id, *links, 0, physicsClientId=self.client)
            else:
                missing = first if first not in self._links else second
                self.logger.warning(
                    "disable_pairs names %r, which is no link; there are %s", missing, list(self._links)
                )

    # ---- the robot's models ------------------------------------------------------------------------------------

    def initialize_robot(self) -> None:
        """Makes `robot` and `dynamics`, from the root to the end effector."""
        if self.robot is not None:
            self.logger.warning("the robot is initialised already")
            return
        processor = URDFToSerialManipulator(self.urdf_file_path)
        self.set_robot_models(processor.serial_manipulator, processor.dynamics)

    def set_robot_models(self, robot: SerialManipulator, dynamics: ManipulatorDynamics) -> None:
        """Takes models that were made elsewhere."""
        self.robot, self.dynamics = robot, dynamics
        self.logger.info("the robot has its models")

    def initialize_planner_and_controller(self) -> None:
        """Makes `trajectory_planner` and `controller`, and the models if there are none."""
        if self.robot is None or self.dynamics is None:
            self.initialize_robot()
        assert self.robot is not None and self.dynamics is not None
        self.trajectory_planner = TrajectoryPlanning(
            self.robot, self.urdf_file_path, self.dynamics, self.joint_limits, self.torque_limits_as_pairs()
        )
        self.controller = ManipulatorController(self.dynamics)

    def torque_limits_as_pairs(self) -> Array | None:
        """(n, 2), or None."""
        if self.torque_limits is None:
            return None
        given = np.asarray(self.torque_limits, np.float64)
        return given if given.ndim == 2 else np.stack([-np.abs(given), np.abs(given)], axis=1)

    # ---- joints ------------------------------------------------------------------------------------------------

    def set_joint_positions(self, joint_positions: ArrayLike, forces: Sequence[float] | None = None) -> None:
        """Sends the motors to positions (n,), with the forces of torque_limits at most, or `forces` (n,)."""
        p.setJointMotorControlArray(
            self.robot_id,
            self.non_fixed_joints,
            p.POSITION_CONTROL,
            targetPositions=[float(x) for x in np.asarray(joint_positions, np.float64)],
            forces=self._forces() if forces is None else list(forces),
            physicsClientId=self.client,
        )

    def _forces(self) -> list[float]:
        if self.torque_limits is None:
            return [_STRONG] * len(self.non_fixed_joints)
        given = np.asarray(self.torque_limits, np.float64)
        return [float(x) for x in (np.abs(given).max(axis=1) if given.ndim == 2 else given)]

    def _joint_states(self) -> list[Any]:
        return p.getJointStates(self.robot_id, self.non_fixed_joints, physicsClientId=self.client)

    def get_joint_positions(self) -> Array:
        """(n,)"""
        return np.array([state[0] for state in self._joint_states()])

    def get_joint_parameters(self) -> list[float]:
        """The values of the joints' sliders."""
        return [self._sliders.read(number) for number in self.joint_params]

    def save_joint_states(self, filename: str = "joint_states.csv") -> None:
        """Writes positions and velocities, one row for each joint."""
        rows = [state[:2] for state in self._joint_states()]
        with replacing(Path(filename)) as temporary:
            np.savetxt(temporary, rows, delimiter=",", header="Position,Velocity", comments="")
        self.logger.info("joint states are in %s", filename)

    # ---- time --------------------------------------------------------------------------------------------------

    def step_simulation(self) -> None:
        """One step, with gravity and time step as their sliders are, if there are any."""
        if self.gravity_param is not None:
            self.update_simulation_parameters()
        p.stepSimulation(physicsClientId=self.client)
        self.on_step()

    def on_step(self) -> None:
        """Called after every step of every loop. Put a function of your own in its place to move sliders and press the
        button, or to end a loop by raising KeyboardInterrupt."""

    def _paced(self, rows: Iterable[Any]) -> Iterable[Any]:
        """The rows, one each time_step / real_time_factor on the wall's clock."""
        due = time.perf_counter()
        for row in rows:
            yield row
            due = self._sleep_until(due)

    def _sleep_until(self, due: float) -> float:
        factor = self.real_time_factor
        if not factor or math.isinf(factor):
            return due
        due += self.time_step / factor
        time.sleep(max(0.0, due - time.perf_counter()))
        return max(due, time.perf_counter() - self.time_step)

    def end_effector_position(self) -> Place:
        """Where the end effector is now."""
        if self._tip < 0:
            return p.getBasePositionAndOrientation(self.robot_id, physicsClientId=self.client)[0]
        state = p.getLinkState(self.robot_id, self._tip, computeForwardKinematics=True, physicsClientId=self.client)
        return tuple(state[4])

    # ---- trajectories ------------------------------------------------------------------------------------------

    def run_trajectory(self, joint_trajectory: Any, steps_per_row: int = 1) -> Place:
        """Sends the motors through positions (N, n), one row a step, draws the way of the end effector, and returns
        where it is. As in PyBullet, motors remove a tenth of their error in each step; steps_per_row gives them
        more."""
        self.logger.info("running a trajectory")
        return self._play(self._rows(joint_trajectory), steps_per_row)

    def simulate_robot_motion(self, desired_angles_trajectory: Any) -> Place:
        """`run_trajectory` by another name."""
        self.logger.info("simulating a motion")
        return self._play(self._rows(desired_angles_trajectory), 1)

    def run_controller(self, desired_positions: Any) -> Place:
        """The same of any rows: an array, a list, a generator."""
        rows = self._rows(desired_positions)
        self.logger.info("tracking %d positions", len(rows))
        return self._play(rows, 1)

    def _rows(self, given: Any) -> Array:
        if hasattr(given, "get") and not hasattr(given, "keys"):
            given = given.get()  # of an array on a graphics card
        rows = np.asarray(given if isinstance(given, np.ndarray | Sequence) else list(given), np.float64)
        if rows.size == 0:
            raise ValueError("the trajectory is empty; expected one row or more")
        if rows.ndim != 2:
            raise ValueError(f"the trajectory has shape {rows.shape}; expected (N, {len(self.non_fixed_joints)})")
        if rows.shape[1] != len(self.non_fixed_joints):
            raise ValueError(
                f"the trajectory has {rows.shape[1]} columns; "
                f"the robot has {len(self.non_fixed_joints)} joints that move"
            )
        if not np.isfinite(rows).all():
            raise ValueError("the trajectory must be finite")
        return rows

    def _play(self, rows: Array, steps_per_row: int) -> Place:
        places = []
        for row in self._paced(rows):
            self.set_joint_positions(row)
            for _ in range(steps_per_row):
                self.step_simulation()
            places.append(self.end_effector_position())
        off = float(np.abs(self.get_joint_positions() - rows[-1]).max())
        self.logger.info("the joints are %.3g rad or m from the last row", off)
        self.plot_trajectory(places)
        return places[-1]

    def simulate_robot_with_desired_angles(self, desired_angles: ArrayLike, duration: float = math.inf) -> None:
        """Sends the motors to angles (n,) and steps for a duration [s], or until Ctrl-C."""
        self.set_joint_positions(desired_angles, [_STRONG] * len(self.non_fixed_joints))
        with self._closing_on_errors():
            elapsed, due = 0.0, time.perf_counter()
            while elapsed < duration:
                self.step_simulation()
                elapsed += self.time_step
                due = self._sleep_until(due)

    @contextlib.contextmanager
    def _closing_on_errors(self) -> Any:
        """Ctrl-C ends a loop and closes the simulation; so does anything else, which goes on."""
        try:
            yield
        except KeyboardInterrupt:
            self.logger.info("interrupted")
            self.close_simulation()
        except BaseException:
            self.close_simulation()
            raise

    # ---- sliders and buttons -----------------------------------------------------------------------------------

    def add_joint_parameters(self) -> None:
        """A slider for every joint that moves, once."""
        if self.joint_params:
            return
        for k, (low, high) in zip(self.non_fixed_joints, self.joint_limits, strict=True):
            self.joint_params.append(self._sliders.add(f"Joint {k}", low, high, min(max(0.0, low), high)))

    def add_reset_button(self) -> None:
        """The button "Reset", once."""
        if self.reset_button is None:
            try:
                self.reset_button = self._sliders.add("Reset", 1, 0, 1)
            except p.error as reason:
                self.logger.error("there is no reset button: %s", reason)

    def add_additional_parameters(self) -> None:
        """Sliders of gravity and time step, once."""
        if self.gravity_param is None:
            self.gravity_param = self._sliders.add("Gravity", -20, 20, _GRAVITY)
            self.time_step_param = self._sliders.add("Time Step", 0.001, 0.1, min(max(self.time_step, 0.001), 0.1))

    def set_parameter(self, number: int, value: float) -> None:
        """Moves a slider, one of joint_params, gravity_param or time_step_param, as people do."""
        self._sliders.set(number, value)

    def press_reset(self) -> None:
        """Presses the reset button."""
        if self.reset_button is None:
            raise RuntimeError("there is no reset button; call add_reset_button first")
        self._sliders.press(self.reset_button)

    def update_simulation_parameters(self) -> None:
        """Takes over gravity and time step from their sliders."""
        if self.gravity_param is None or self.time_step_param is None:
            raise AttributeError("there are no sliders of gravity and time step; call add_additional_parameters first")
        self.time_step = self._sliders.read(self.time_step_param)
        p.setGravity(0, 0, self._sliders.read(self.gravity_param), physicsClientId=self.client)
        p.setTimeStep(self.time_step, physicsClientId=self.client)

    def _clicks(self) -> float:
        return 0.0 if self.reset_button is None else self._sliders.read(self.reset_button)

    def manual_control(self) -> None:
        """The joints follow their sliders until the reset button is pressed, which sends them home; Ctrl-C closes the
        simulation. Sliders and button are added if there are none."""
        self.add_joint_parameters()
        self.add_additional_parameters()
        self.add_reset_button()
        self.logger.info("the joints follow their sliders")
        clicks = self._clicks()
        with self._closing_on_errors():
            due = time.perf_counter()
            while self._clicks() == clicks:
                self.set_joint_positions(self.get_joint_parameters())
                self.check_collisions()
                self.step_simulation()
                due = self._sleep_until(due)
            self.logger.info("reset: the joints go home")
            assert self.home_position is not None
            self.set_joint_positions(self.home_position)

    def run(self, joint_trajectory: Any) -> None:
        """Plays a trajectory, waits for the reset button, goes home and lets the sliders lead until it is pressed
        again; and so on. Ctrl-C closes the simulation."""
        rows = self._rows(joint_trajectory)
        self.add_reset_button()
        with self._closing_on_errors():
            while True:
                self.run_trajectory(rows)
                self._wait_for_reset()
                assert self.home_position is not None
                self.set_joint_positions(self.home_position)
                self.manual_control()
                if self.physics_client is None:  # Ctrl-C has closed it
                    return

    def _wait_for_reset(self) -> None:
        clicks = self._clicks()
        while self._clicks() == clicks:
            self.step_simulation()
            if self.real_time_factor:
                time.sleep(_WAIT)

    # ---- collisions and trails ---------------------------------------------------------------------------------

    def check_collisions(self) -> list[tuple[int, int, Place]]:
        """(link, link, place) of every point at which the robot touches itself; -1 is the base. Empty unless
        self-collision is enabled."""
        if self.robot_id is None:
            self.logger.warning("there is no robot")
            return []
        points = p.getContactPoints(self.robot_id, self.robot_id, physicsClientId=self.client)
        found = [(int(point[3]), int(point[4]), tuple(point[5])) for point in points]
        for first, second, place in found:
            self.logger.warning("links %d and %d touch at %s", first, second, place)
        return found

    def plot_trajectory(
        self, ee_positions: Any, line_width: float = 3, color: Sequence[float] | None = None
    ) -> list[int]:
        """Draws a way (N, 3), red by default, with balls where it begins and ends: cameras see it, bodies do not touch
        it. The ids of the way's bodies, without those of the balls. The last way is cleared."""
        self.clear_trajectory_visualization()
        places = np.asarray(ee_positions, np.float64).reshape(-1, 3)
        if len(places) < 2:
            self.logger.warning("a way of %d places is not drawn", len(places))
            return []
        segments, balls = draw_trail(self.client, places, line_width, [1, 0, 0] if color is None else list(color))
        self.trajectory_body_ids = segments + balls
        return segments

    def clear_trajectory_visualization(self) -> None:
        """Takes the drawn way away."""
        for body in self.trajectory_body_ids:
            self._remove(body)
        self.trajectory_body_ids = []

    def _remove(self, body: int) -> None:
        try:
            p.removeBody(body, physicsClientId=self.client)
        except (p.error, RuntimeError) as reason:
            self.logger.warning("body %d of the way cannot be removed: %s", body, reason)

    def plot_trajectory_in_scene(self, joint_trajectory: Any, end_effector_trajectory: Any) -> None:
        """Shows the way of the end effector (N, 3) as a Matplotlib plot, then plays the joints' trajectory."""
        import matplotlib.pyplot as plt

        places = np.asarray(end_effector_trajectory, np.float64).reshape(-1, 3)
        axis = plt.figure().add_subplot(projection="3d")
        axis.plot(*places.T, label="End-Effector Trajectory")
        axis.set(xlabel="X", ylabel="Y", zlabel="Z")
        axis.legend()
        plt.show()
        self.run_trajectory(joint_trajectory)

    def __del__(self) -> None:
        with contextlib.suppress(Exception):  # the interpreter may be about to end
            if self.trajectory_body_ids and self.physics_client is not None:
                self.clear_trajectory_visualization()
