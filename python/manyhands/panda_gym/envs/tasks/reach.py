"""Bring the hand to a point."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from manyhands.panda_gym.envs.tasks.goal_task import GREEN, TARGET_ALPHA, GoalTask, square
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.rotations import Array


class Reach(GoalTask):
    """Goal (3): where the hand should be. Nothing is observed besides the robot."""

    def __init__(
        self,
        sim: PyBullet,
        get_ee_position: Callable[[], ArrayLike],
        reward_type: str = "sparse",
        distance_threshold: float = 0.05,
        goal_range: float = 0.3,
    ) -> None:
        super().__init__(sim, reward_type, distance_threshold)
        self.get_ee_position = get_ee_position
        self.goal_range_low, self.goal_range_high = square(goal_range, height=goal_range)
        with sim.no_rendering():
            self.create_surroundings()
            sim.create_sphere("target", 0.02, 0.0, np.zeros(3), rgba_color=(*GREEN, TARGET_ALPHA), ghost=True)

    def reset(self) -> None:
        self.goal = self.draw(self.goal_range_low, self.goal_range_high)
        self.put("target", self.goal)

    def get_obs(self) -> Array:
        return np.zeros(0)

    def get_achieved_goal(self) -> Array:
        return np.array(self.get_ee_position())
