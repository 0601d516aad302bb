"""An arm brings its flange to a place."""

from typing import Any, ClassVar

import numpy as np

from manyhands._core import World, asset_path
from manyhands.world_envs.world_env import Array, View, WorldEnv, marker

HAND = "kuka/lbr_iiwa_link_7"


class KukaReach(WorldEnv):
    """A Kuka iiwa with seven joints, and a target somewhere before it.

    An action moves the seven motors' targets by up to 0.1 rad. Observed are the joints' angles (7) and velocities (7),
    the flange (3) and the target (3). The reward is the distance to the target, negative, and 10 at the end: within
    5 cm the episode is over.
    """

    HOME: ClassVar[Array] = np.array([0.0, 0.4, 0.0, -1.2, 0.0, 1.0, 0.0])  # [rad]
    MAX_TORQUE = 200.0  # [N m]
    REACH = 0.1  # of an action [rad]
    CLOSE = 0.05  # [m]
    TARGETS = (0.3, -0.3, 0.3), (0.7, 0.3, 0.7)  # [m]

    def __init__(self, **options: Any) -> None:
        """options: `render_mode` and `randomize`, see `WorldEnv`."""
        world = World(time_step=0.004)
        world.add_plane("floor")
        world.add(asset_path("bullet/kuka_iiwa/model.urdf"), name="kuka")
        world.add(marker("target", self.CLOSE / 2))
        world.q = self.HOME
        super().__init__(
            world, actions=7, observations=20, substeps=10, view=View((0.25, 0.0, 0.45), 1.6, 25, -15), **options
        )
        joints = [joint for joint in self.model.joints if joint.nv == 1]
        self._lower, self._upper = (np.array([getattr(j, end) for j in joints]) for end in ("lower", "upper"))
        self.goal, self._target = np.zeros(3), self.HOME

    def begin(self) -> None:
        self.goal, self._target = self.draw_target(*self.TARGETS), self.HOME
        self.world.set_mocap("target", self.goal)

    def act(self, action: Array) -> None:
        self._target = (self._target + self.REACH * action).clip(self._lower, self._upper)
        self.world.set_motors(target_q=self._target, max_force=self.MAX_TORQUE * self.varied["motor_force"])
        self.world.step(self.substeps)

    def look(self) -> Array:
        return np.concatenate([self.world.q, self.world.v, self.world.body_pose(HAND)[0], self.goal])

    def judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        distance = float(np.linalg.norm(self.world.body_pose(HAND)[0] - self.goal))
        is_close = distance < self.CLOSE
        return 10.0 * is_close - distance, is_close, {"is_success": is_close, "distance": distance}
