"""Slide a puck to a place that the hand does not reach."""

import numpy as np

from manyhands.panda_gym.envs.tasks.goal_task import GREEN, TARGET_ALPHA, PlaceObject, square
from manyhands.panda_gym.pybullet import PyBullet


class Slide(PlaceObject):
    """Goal (3): where the puck's centre should be. Observes the puck (12).

    The goal's height is the puck's and not half of it, as in panda-gym: a puck that lies still is 15 mm off.
    """

    def __init__(
        self,
        sim: PyBullet,
        reward_type: str = "sparse",
        distance_threshold: float = 0.05,
        goal_xy_range: float = 0.3,
        goal_x_offset: float = 0.4,
        obj_xy_range: float = 0.3,
    ) -> None:
        super().__init__(sim, reward_type, distance_threshold)
        self.object_size = 0.06
        self.goal_range_low, self.goal_range_high = square(goal_xy_range, goal_x_offset)
        self.obj_range_low, self.obj_range_high = square(obj_xy_range)
        radius = height = self.object_size / 2
        self._rest = np.array([0.0, 0.0, height])
        with sim.no_rendering():
            self.create_surroundings(table_length=1.4, table_x_offset=-0.1)
            sim.create_cylinder(
                "object", radius, height, 1.0, self._rest, rgba_color=(*GREEN, 1.0), lateral_friction=0.04
            )
            sim.create_cylinder(
                "target", radius, height, 0.0, self._rest, rgba_color=(*GREEN, TARGET_ALPHA), ghost=True
            )
