"""Stack two cubes."""

import numpy as np

from manyhands.panda_gym.envs.tasks.goal_task import BLUE, GREEN, GoalTask, square
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.rotations import Array


class Stack(GoalTask):
    """Goal (6): where the centres of both cubes should be, the second above the first. Observes both cubes (24)."""

    def __init__(
        self,
        sim: PyBullet,
        reward_type: str = "sparse",
        distance_threshold: float = 0.1,
        goal_xy_range: float = 0.3,
        obj_xy_range: float = 0.3,
    ) -> None:
        super().__init__(sim, reward_type, distance_threshold)
        self.object_size = size = 0.04
        self.goal_range_low, self.goal_range_high = square(goal_xy_range)
        self.obj_range_low, self.obj_range_high = square(obj_xy_range)
        self._places = np.array([0.0, 0.0, size / 2]), np.array([0.0, 0.0, 3 * size / 2])
        aside = np.array([0.5, 0.0, size / 2])
        with sim.no_rendering():
            self.create_surroundings()
            self.create_cube("1", size, 2.0, BLUE, [self._places[0], self._places[0]])
            self.create_cube("2", size, 1.0, GREEN, [aside, aside])

    def reset(self) -> None:
        offset = self.draw(self.goal_range_low, self.goal_range_high)
        self.goal = np.concatenate([place + offset for place in self._places])
        starts = [place + self.draw(self.obj_range_low, self.obj_range_high) for place in self._places]
        for number, start, goal in zip("12", starts, (self.goal[:3], self.goal[3:]), strict=True):
            self.put(f"target{number}", goal)
            self.put(f"object{number}", start)

    def get_obs(self) -> Array:
        return np.concatenate([self.object_state("object1"), self.object_state("object2")])

    def get_achieved_goal(self) -> Array:
        return np.concatenate([self.sim.get_base_position("object1"), self.sim.get_base_position("object2")])
