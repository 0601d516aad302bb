"""A robot on four legs, its base free, walks ahead without falling."""

from typing import Any, ClassVar

import numpy as np

from manyhands import rotations
from manyhands._core import World, asset_path, load_urdf
from manyhands.world_envs.world_env import Array, View, WorldEnv

TRUNK = "a1/trunk"


class QuadrupedWalk(WorldEnv):
    """A robot of 12 kg on four legs of three joints each, free to fall.

    An action is where the twelve motors are to go, within 0.5 rad of standing: hip, upper and lower leg in front on
    the right, on the left, then behind on the right, on the left. Observed are the trunk's height (1), the way down in
    its frame (3), its velocity (3) and angular velocity (3) there, the joints' angles beyond standing (12) and
    velocities (12), and the speed asked for (1). The reward is 1 for each step on its feet, as much again for the
    speed that is asked for, less for turning and for jerky motors. The episode is over when the trunk is low or leans.
    """

    STANDING: ClassVar[Array] = np.tile([0.0, 0.83, -1.66], 4)  # [rad]
    HEIGHT = 0.29  # of the trunk, standing [m]
    MAX_TORQUE: ClassVar[Array] = np.tile([20.0, 55.0, 55.0], 4)  # [N m]
    STRIDE = 0.5  # of an action [rad]
    SPEED = 0.4  # at most that is asked for [m/s]
    LOW, LEANING = 0.15, 0.5  # height [m], and cosine to the upright, of what has fallen

    def __init__(self, **options: Any) -> None:
        """options: `render_mode` and `randomize`, see `WorldEnv`."""
        world = World(time_step=0.004)
        world.add_plane("floor", friction=0.8)
        robot, _ = load_urdf(asset_path("bullet/a1/a1.urdf"), fixed_base=False)
        world.add(robot, (0.0, 0.0, self.HEIGHT), name="a1")
        world.q = np.concatenate([world.q[:7], self.STANDING])
        super().__init__(
            world, actions=12, observations=35, substeps=5, view=View((0.15, 0.0, 0.15), 1.1, 40, -18), **options
        )
        self.speed, self._last = 0.0, np.zeros(12)

    def begin(self) -> None:
        self.speed = float(self.draw_target([0.0], [self.SPEED])[0])
        self._last = np.zeros(12)
        self.world.q = np.concatenate([self.world.q[:7], self.STANDING + self.np_random.uniform(-0.05, 0.05, 12)])

    def act(self, action: Array) -> None:
        legs = self.STANDING + self.STRIDE * action
        force = self.MAX_TORQUE * self.varied["motor_force"]
        self.world.set_motors(
            target_q=np.concatenate([np.zeros(6), legs]), max_force=np.concatenate([np.zeros(6), force])
        )
        self.world.step(self.substeps)

    def look(self) -> Array:
        height, down, velocity, omega = self._trunk()
        q, v = self.world.q[7:], self.world.v[6:]
        return np.concatenate([[height], down, velocity, omega, q - self.STANDING, v, [self.speed]])

    def judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        height, down, velocity, omega = self._trunk()
        has_fallen = height < self.LOW or -down[2] < self.LEANING
        missed = abs(float(velocity[0]) - self.speed) / self.SPEED
        jerk = float(np.square(action - self._last).mean())
        self._last = action
        reward = 1 + np.exp(-4 * missed**2) - 0.05 * min(float(np.linalg.norm(omega)), 10.0) - 0.1 * jerk
        info = {"is_success": not has_fallen and missed < 0.25, "velocity": float(velocity[0])}
        return float(reward) * (not has_fallen), bool(has_fallen), info

    def _trunk(self) -> tuple[float, Array, Array, Array]:
        """Height [m]; the way down, velocity and angular velocity, in the trunk's axes."""
        position, quaternion = self.world.body_pose(TRUNK)
        omega, velocity = self.world.body_velocity(TRUNK)
        back = rotations.conjugate(quaternion)
        down, velocity, omega = (rotations.rotate(back, each) for each in (np.array([0.0, 0.0, -1.0]), velocity, omega))
        return float(position[2]), down, velocity, omega
