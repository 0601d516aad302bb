"""Turn a cube with coloured faces."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from manyhands.panda_gym.envs.tasks.goal_task import GoalTask, square
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.panda_gym.utils import angle_distance
from manyhands.rotations import Array

_TEXTURE = "colored_cube.png"


class Flip(GoalTask):
    """Goal (4): the cube's quaternion. Observes the cube, its rotation by quaternion (13).

    The distance is that of `utils.angle_distance`; the threshold of 0.2 is 53 degrees.
    """

    def __init__(
        self,
        sim: PyBullet,
        reward_type: str = "sparse",
        distance_threshold: float = 0.2,
        obj_xy_range: float = 0.3,
    ) -> None:
        super().__init__(sim, reward_type, distance_threshold)
        self.object_size = size = 0.04
        self.obj_range_low, self.obj_range_high = square(obj_xy_range)
        self._rest, self._above = np.array([0.0, 0.0, size / 2]), np.array([0.0, 0.0, 3 * size / 2])
        half = np.full(3, size / 2)
        with sim.no_rendering():
            self.create_surroundings()
            sim.create_box("object", half, 1.0, self._rest, texture=_TEXTURE)
            sim.create_box(
                "target", half, 0.0, self._above, rgba_color=(1.0, 1.0, 1.0, 0.5), ghost=True, texture=_TEXTURE
            )

    def distance(self, achieved_goal: ArrayLike, desired_goal: ArrayLike) -> Any:
        return angle_distance(achieved_goal, desired_goal)

    def reset(self) -> None:
        quaternion = self.np_random.normal(size=4)
        self.goal = quaternion / np.linalg.norm(quaternion)
        start = self._rest + self.draw(self.obj_range_low, self.obj_range_high)
        self.put("target", self._above, self.goal)
        self.put("object", start)

    def get_obs(self) -> Array:
        return self.object_state(rotation="quaternion")

    def get_achieved_goal(self) -> Array:
        return self.sim.get_base_rotation("object", "quaternion")
