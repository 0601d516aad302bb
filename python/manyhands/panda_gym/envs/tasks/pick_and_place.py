"""Take a cube and bring it to a place, on the table or above."""

import numpy as np

from manyhands.panda_gym.envs.tasks.goal_task import GREEN, PlaceObject, square
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.rotations import Array

_SHARE_ON_TABLE = 0.3


class PickAndPlace(PlaceObject):
    """Goal (3): where the cube's centre should be. Observes the cube (12)."""

    def __init__(
        self,
        sim: PyBullet,
        reward_type: str = "sparse",
        distance_threshold: float = 0.05,
        goal_xy_range: float = 0.3,
        goal_z_range: float = 0.2,
        obj_xy_range: float = 0.3,
    ) -> None:
        super().__init__(sim, reward_type, distance_threshold)
        self.object_size = 0.04
        self.goal_range_low, self.goal_range_high = square(goal_xy_range, height=goal_z_range)
        self.obj_range_low, self.obj_range_high = square(obj_xy_range)
        self._rest = np.array([0.0, 0.0, self.object_size / 2])
        with sim.no_rendering():
            self.create_surroundings()
            self.create_cube("", self.object_size, 1.0, GREEN, [self._rest, self._rest])

    def draw_goal(self) -> Array:
        offset = self.draw(self.goal_range_low, self.goal_range_high)
        if self.np_random.random() < _SHARE_ON_TABLE:
            offset[2] = 0.0
        return self._rest + offset
