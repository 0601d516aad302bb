"""What the six environments share: a Panda at a table."""

from abc import abstractmethod
from inspect import signature
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from manyhands.envs.options import require_known
from manyhands.panda_gym.envs.core import RobotTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.goal_task import GoalTask
from manyhands.panda_gym.pybullet import PyBullet

BASE_POSITION = (-0.6, 0.0, 0.0)


class PandaTaskEnv(RobotTaskEnv):
    """reward_type: "sparse" or "dense"; control_type: "ee", displacements of the hand, or "joints".

    `render`, or a bool in the first place, asks for panda-gym 2 and the old gym, see `RobotTaskEnv`. A step takes
    n_substeps of time_step [s]. distance_threshold: success is nearer than this; 0: what the task says. joint_forces:
    see `Panda`.
    """

    block_gripper: ClassVar[bool]

    def __init__(
        self,
        render_mode: str | bool | None = "rgb_array",
        reward_type: str = "sparse",
        control_type: str = "ee",
        renderer: str = "Tiny",
        render_width: int = 720,
        render_height: int = 480,
        render_target_position: ArrayLike | None = None,
        render_distance: float = 1.4,
        render_yaw: float = 45,
        render_pitch: float = -30,
        render_roll: float = 0,
        *,
        render: bool | None = None,
        n_substeps: int = 20,
        time_step: float = 0.002,
        terminate_on_success: bool = True,
        distance_threshold: float = 0.0,
        joint_forces: ArrayLike | None = None,
        **unknown: Any,
    ) -> None:
        """Raises ValueError on an unknown mode, renderer or type, TypeError on an unknown option."""
        require_known(unknown, [name for name in signature(PandaTaskEnv).parameters if name != "unknown"])
        mode = "rgb_array" if render_mode is None else render_mode
        sim = PyBullet(mode, n_substeps, renderer=renderer, render=render, timestep=time_step)
        robot = Panda(sim, self.block_gripper, BASE_POSITION, control_type, joint_forces=joint_forces)
        task = self.make_task(sim, robot, reward_type)
        if distance_threshold:
            task.distance_threshold = distance_threshold
        super().__init__(
            robot,
            task,
            render_width,
            render_height,
            render_target_position,
            render_distance,
            render_yaw,
            render_pitch,
            render_roll,
            terminate_on_success=terminate_on_success,
        )

    @abstractmethod
    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> GoalTask:
        """The task, its objects in `sim`."""
