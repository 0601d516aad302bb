"""What the six tasks share: rewards by a distance, and a table with objects."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.panda_gym.envs.core import Task
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.panda_gym.utils import distance
from manyhands.rotations import IDENTITY, Array

GREEN, BLUE = (0.1, 0.9, 0.1), (0.1, 0.1, 0.9)
TARGET_ALPHA = 0.3


class GoalTask(Task):
    """Success is a distance below the threshold. The reward is -1 until then and 0 afterwards ("sparse"), or minus the
    distance ("dense"): float32, for goals (..., n) of shape (...)."""

    def __init__(self, sim: PyBullet, reward_type: str, distance_threshold: float) -> None:
        """Raises ValueError on an unknown reward_type."""
        super().__init__(sim)
        if reward_type not in ("sparse", "dense"):
            raise ValueError(f"reward_type is {reward_type!r}, expected 'sparse' or 'dense'")
        self.reward_type = reward_type
        self.distance_threshold = distance_threshold

    def distance(self, achieved_goal: ArrayLike, desired_goal: ArrayLike) -> Any:
        """(...) of goals (..., n)."""
        return distance(achieved_goal, desired_goal)

    def is_success(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any = {}) -> NDArray[np.bool_]:  # noqa: B006
        return np.array(self.distance(achieved_goal, desired_goal) < self.distance_threshold, dtype=np.bool_)

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any = {}) -> Any:  # noqa: B006
        d = self.distance(achieved_goal, desired_goal)
        reward = np.where(d > self.distance_threshold, -1.0, 0.0) if self.reward_type == "sparse" else -d
        return np.asarray(reward, np.float32)[()]

    def create_surroundings(self, table_length: float = 1.1, table_x_offset: float = -0.3) -> None:
        """The floor and the table."""
        self.sim.create_plane(z_offset=-0.4)
        self.sim.create_table(length=table_length, width=0.7, height=0.4, x_offset=table_x_offset)

    def create_cube(self, number: str, size: float, mass: float, rgb: tuple[float, ...], places: list[Array]) -> None:
        """The cube "object" and its ghost "target", the number behind their names, at two places (3) [m]."""
        half = np.full(3, size / 2)
        self.sim.create_box(f"object{number}", half, mass, places[0], rgba_color=(*rgb, 1.0))
        self.sim.create_box(f"target{number}", half, 0.0, places[1], rgba_color=(*rgb, TARGET_ALPHA), ghost=True)

    def draw(self, low: Array, high: Array) -> Array:
        """A point (3) between two, one number of the stream for each coordinate."""
        return self.np_random.uniform(low, high)

    def put(self, name: str, position: ArrayLike, orientation: ArrayLike = IDENTITY) -> None:
        """At rest."""
        self.sim.set_base_pose(name, position, orientation)

    def object_state(self, name: str = "object", rotation: str = "euler") -> Array:
        """Position, rotation, velocity, angular velocity: 12 numbers, or 13 with a quaternion."""
        sim = self.sim
        return np.concatenate(
            [
                sim.get_base_position(name),
                sim.get_base_rotation(name, rotation),
                sim.get_base_velocity(name),
                sim.get_base_angular_velocity(name),
            ]
        )


class PlaceObject(GoalTask):
    """One object is to come to a place. Goal (3): where its centre should be. Observes the object (12).

    `_rest` (3), `goal_range_low/high` and `obj_range_low/high` (3) say from where, and how far, goals and starts are
    drawn.
    """

    _rest: Array
    goal_range_low: Array
    goal_range_high: Array
    obj_range_low: Array
    obj_range_high: Array

    def draw_goal(self) -> Array:
        """Where the object should be, drawn before where it starts."""
        return self._rest + self.draw(self.goal_range_low, self.goal_range_high)

    def reset(self) -> None:
        self.goal = self.draw_goal()
        start = self._rest + self.draw(self.obj_range_low, self.obj_range_high)
        self.put("target", self.goal)
        self.put("object", start)

    def get_obs(self) -> Array:
        return self.object_state()

    def get_achieved_goal(self) -> Array:
        return self.sim.get_base_position("object")


def square(side: float, x_offset: float = 0.0, height: float = 0.0) -> tuple[Array, Array]:
    """The corners (3) of what lies within a square around (x_offset, 0), from z = 0 to the height."""
    half = side / 2
    return np.array([x_offset - half, -half, 0.0]), np.array([x_offset + half, half, height])
