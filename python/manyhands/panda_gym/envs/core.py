"""Robots, tasks, and environments made of the two."""

from abc import ABC, abstractmethod
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from manyhands.panda_gym.pybullet import PyBullet
from manyhands.rotations import Array

_KEYS = ("observation", "achieved_goal", "desired_goal")
_BOUND = 10.0


class PyBulletRobot(ABC):
    """A robot of a URDF file, its base fixed at base_position (3) [m].

    A robot of one's own names the joints to command (joint_indices, as they come in the file from the root on) and
    their greatest forces (joint_forces), and defines `set_action`, `get_obs` and `reset`.
    """

    def __init__(
        self,
        sim: PyBullet,
        body_name: str,
        file_name: str,
        base_position: ArrayLike,
        action_space: spaces.Space[Any],
        joint_indices: NDArray[Any],
        joint_forces: NDArray[Any],
    ) -> None:
        self.sim = sim
        self.body_name = body_name
        self.action_space = action_space
        self.joint_indices = joint_indices
        self.joint_forces = joint_forces
        with self.sim.no_rendering():
            self._load_robot(file_name, base_position)
            self.setup()

    def _load_robot(self, file_name: str, base_position: ArrayLike) -> None:
        """To be replaced where a robot comes from elsewhere."""
        self.sim.loadURDF(body_name=self.body_name, fileName=file_name, basePosition=base_position, useFixedBase=True)

    def setup(self) -> None:  # noqa: B027  a hook that may stay empty
        """Called once the robot is loaded."""

    @abstractmethod
    def set_action(self, action: Any) -> None:
        """Commands the joints; the simulation steps next."""

    @abstractmethod
    def get_obs(self) -> Any:
        """What is observed of the robot: an array (n), or a number."""

    @abstractmethod
    def reset(self) -> None:
        """Puts the robot where episodes start."""

    def get_link_position(self, link: int) -> Array:
        """Of the link's centre of mass (3) [m]."""
        return self.sim.get_link_position(self.body_name, link)

    def get_link_velocity(self, link: int) -> Array:
        """Of the link's centre of mass (3) [m/s]."""
        return self.sim.get_link_velocity(self.body_name, link)

    def get_joint_angle(self, joint: int) -> float:
        """[rad], or [m] of a prismatic joint."""
        return self.sim.get_joint_angle(self.body_name, joint)

    def get_joint_velocity(self, joint: int) -> float:
        """[rad/s], or [m/s] of a prismatic joint."""
        return self.sim.get_joint_velocity(self.body_name, joint)

    def control_joints(self, target_angles: ArrayLike) -> None:
        """Drives all of joint_indices towards target angles, with at most joint_forces."""
        self.sim.control_joints(
            body=self.body_name, joints=self.joint_indices, target_angles=target_angles, forces=self.joint_forces
        )

    def set_joint_angles(self, angles: ArrayLike) -> None:
        """Teleports all of joint_indices, at rest."""
        self.sim.set_joint_angles(self.body_name, joints=self.joint_indices, angles=angles)

    def inverse_kinematics(self, link: int, position: ArrayLike, orientation: ArrayLike) -> Array:
        """Positions of all movable joints that bring a link closer to a pose, see `PyBullet.inverse_kinematics`."""
        return self.sim.inverse_kinematics(self.body_name, link=link, position=position, orientation=orientation)


class Task(ABC):
    """What is to be done in a simulation. A task of one's own sets `self.goal` in `reset`.

    Environments give it `np_random`, their generator of random numbers.
    """

    np_random: np.random.Generator

    def __init__(self, sim: PyBullet) -> None:
        self.sim = sim
        self.goal: Any = None

    @abstractmethod
    def reset(self) -> None:
        """Draws a goal, and puts objects where the episode starts."""

    @abstractmethod
    def get_obs(self) -> Any:
        """What is observed of the task, besides the robot (n)."""

    @abstractmethod
    def get_achieved_goal(self) -> Any:
        """What there is now of what the goal wants (m)."""

    def get_goal(self) -> Any:
        """A copy of the goal (m). Raises RuntimeError before the first reset."""
        if self.goal is None:
            raise RuntimeError("there is no goal yet: call reset() first")
        return self.goal.copy()

    @abstractmethod
    def is_success(self, achieved_goal: Any, desired_goal: Any, info: Any = {}) -> Any:  # noqa: B006
        """Whether goals (..., m) are reached (...)."""

    @abstractmethod
    def compute_reward(self, achieved_goal: Any, desired_goal: Any, info: Any = {}) -> Any:  # noqa: B006
        """The rewards (...) of goals (..., m)."""


class RobotTaskEnv(gymnasium.Env[dict[str, NDArray[Any]], Any]):
    """An environment of a robot and a task in one simulation.

    Observations are dicts of float32 arrays: `observation`, the robot's and then the task's, `achieved_goal` and
    `desired_goal`. An action is what the robot's `set_action` takes. An episode terminates with success, unless
    `terminate_on_success` is False; `gymnasium.make` limits its length. The same seed and actions give the same bits,
    whatever was before.

    If the simulation was made by `PyBullet(render=...)`, the environment keeps to panda-gym 2 and the old gym: `reset`
    gives the observation alone, in float64, and `step` gives (observation, reward, done, info), where done is False.
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"]}  # noqa: RUF012  as gymnasium has it

    def __init__(
        self,
        robot: PyBulletRobot,
        task: Task,
        render_width: int = 720,
        render_height: int = 480,
        render_target_position: ArrayLike | None = None,
        render_distance: float = 1.4,
        render_yaw: float = 45,
        render_pitch: float = -30,
        render_roll: float = 0,
        *,
        terminate_on_success: bool = True,
    ) -> None:
        assert robot.sim is task.sim, "the robot and the task belong to different simulations"
        self.sim, self.robot, self.task = robot.sim, robot, task
        self.render_mode = self.sim.render_mode
        self.metadata = {**type(self).metadata, "render_fps": 1 / self.sim.dt}
        self.terminate_on_success = terminate_on_success
        self.render_width, self.render_height = render_width, render_height
        target = (0.0, 0.0, 0.0) if render_target_position is None else render_target_position
        self.render_target_position = np.array(target, np.float64)
        self.render_distance = render_distance
        self.render_yaw, self.render_pitch, self.render_roll = render_yaw, render_pitch, render_roll
        self.compute_reward = task.compute_reward
        self.action_space = robot.action_space
        self._saved_goal: dict[int, Any] = {}
        self._begin(None)
        sizes = {key: value.shape for key, value in self._get_obs().items()}
        boxes: dict[str, spaces.Space[Any]] = {
            key: spaces.Box(-_BOUND, _BOUND, sizes[key], np.float32) for key in _KEYS
        }
        self.observation_space: spaces.Space[Any] = spaces.Dict(boxes)
        self.sim.place_visualizer(self.render_target_position, render_distance, render_yaw, render_pitch)

    @property
    def has_old_returns(self) -> bool:
        """Whether `reset` and `step` return what the old gym's do; `manyhands.gym` asks."""
        return self.sim.is_version_2

    def reset(  # pyright: ignore[reportIncompatibleMethodOverride]  panda-gym takes a seed without its name, too
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> Any:
        """Starts an episode: (observation, info). Without a seed the stream of random numbers goes on."""
        self._begin(seed)
        observation = self._get_obs()
        if self.sim.is_version_2:
            return observation
        return observation, {"is_success": self.task.is_success(observation["achieved_goal"], self.task.get_goal())}

    def step(self, action: Any) -> Any:
        """One step of `sim.dt`: (observation, reward, terminated, truncated, info); truncated is always False."""
        self.robot.set_action(action)
        self.sim.step()
        observation, goal = self._get_obs(), self.task.get_goal()
        success = self.task.is_success(observation["achieved_goal"], goal)
        if self.sim.is_version_2:
            info: dict[str, Any] = {"is_success": np.array(success, np.float64)}
            return observation, float(self.task.compute_reward(observation["achieved_goal"], goal, info)), False, info
        info = {"is_success": bool(success)}
        reward = float(self.task.compute_reward(observation["achieved_goal"], goal, info))
        if self.render_mode == "human":
            self.render()
        return observation, reward, bool(success) and self.terminate_on_success, False, info

    def save_state(self) -> int:
        """Keeps the simulation's state and the goal; gives the smallest number that is not in use."""
        state_id = self.sim.save_state()
        self._saved_goal[state_id] = self.task.get_goal()
        return state_id

    def restore_state(self, state_id: int) -> None:
        """Goes back to a saved state, bit for bit. Raises `pybullet.error` on an unknown number."""
        self.sim.restore_state(state_id)
        self.task.goal = self._saved_goal[state_id].copy()

    def remove_state(self, state_id: int) -> None:
        """Forgets a saved state. Raises KeyError on an unknown number."""
        self._saved_goal.pop(state_id)
        self.sim.remove_state(state_id)

    def render(
        self,
        mode: str | None = None,
        width: int | None = None,
        height: int | None = None,
        target_position: ArrayLike | None = None,
        distance: float | None = None,
        yaw: float | None = None,
        pitch: float | None = None,
        roll: float | None = None,
    ) -> Any:
        """As `PyBullet.render`; what is not given is that of the constructor."""
        return self.sim.render(
            width=self.render_width if width is None else width,
            height=self.render_height if height is None else height,
            target_position=self.render_target_position if target_position is None else target_position,
            distance=self.render_distance if distance is None else distance,
            yaw=self.render_yaw if yaw is None else yaw,
            pitch=self.render_pitch if pitch is None else pitch,
            roll=self.render_roll if roll is None else roll,
            mode=mode,
        )

    def close(self) -> None:
        """Ends the simulation; may be called again."""
        self.sim.close()

    def _begin(self, seed: int | None) -> None:
        super().reset(seed=seed)
        self.task.np_random = self.np_random
        with self.sim.no_rendering():
            self.sim.forget()
            self.robot.reset()
            self.task.reset()

    def observe(self) -> dict[str, NDArray[Any]]:
        """What is observed now."""
        return self._get_obs()

    def _get_obs(self) -> dict[str, NDArray[Any]]:
        kind = np.float64 if self.sim.is_version_2 else np.float32

        def row(numbers: Any) -> NDArray[Any]:
            return np.array(numbers, kind, ndmin=1)

        return {
            "observation": np.concatenate([row(self.robot.get_obs()), row(self.task.get_obs())]),
            "achieved_goal": row(self.task.get_achieved_goal()),
            "desired_goal": row(self.task.get_goal()),
        }
