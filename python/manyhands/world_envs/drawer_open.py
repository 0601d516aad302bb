"""An arm takes the handle of a drawer and pulls it open."""

from typing import Any, ClassVar

import numpy as np

from manyhands import rotations
from manyhands._core import World, asset_path, load_urdf
from manyhands.kinematics import inverse_kinematics
from manyhands.world_envs.world_env import Array, View, WorldEnv

HAND = "panda/panda_grasptarget"
JOINT = "drawer/drawer_joint"


class DrawerOpen(WorldEnv):
    """A Panda before a chest, its hand level; the drawer is shut.

    An action moves where the hand is to go by up to 3 cm along x, y and z, and opens the gripper (above 0) or shuts
    it. Observed are the hand (3) and its velocity (3), the gripper's width (1), the handle (3), how far the drawer is
    open (1) and how fast it opens (1). The reward is the distance from the hand to the handle, negative, and five times
    the way that the drawer is open; 10 at the end: 15 cm open, the episode is over.
    """

    HOME: ClassVar[Array] = np.array([0.0, -0.75, 0.0, -2.55, 0.0, 3.38, -0.79])  # [rad]
    MAX_FORCE: ClassVar[Array] = np.array([87.0] * 4 + [12.0] * 3 + [20.0] * 2)  # [N m, N]
    LEVEL: ClassVar[Array] = np.array([0.5, 0.5, 0.5, 0.5])  # the hand points along x, its fingers lie above each other
    STRIDE = 0.03  # of an action [m]
    OPEN = 0.15  # [m]
    CHEST = (0.77, 0.0, 0.62)  # its foot [m]
    PLACES = (-0.04, -0.12), (0.04, 0.12)  # of the chest beyond that, along x and y [m]
    TURNED = (0.0, 0.0, 1.0, 0.0)  # the chest faces the arm
    START = (0.38, 0.0, 0.74)  # of the hand [m]
    WORKSPACE = (0.3, -0.25, 0.62), (0.65, 0.25, 0.85)  # of the hand [m]

    def __init__(self, **options: Any) -> None:
        """options: `render_mode` and `randomize`, see `WorldEnv`."""
        world = World(time_step=0.004)
        world.add_plane("floor")
        world.add_box("stand", (0.21, 0.31, 0.31), position=(0.78, 0.0, 0.31), fixed=True)
        chest, _ = load_urdf(asset_path("bullet/drawer/drawer.urdf"), fixed_base=False)  # it stands by its weight
        world.add(chest, self.CHEST, self.TURNED, name="drawer")
        world.add(asset_path("panda/panda.urdf"), name="panda")
        model = world.model
        joints = [joint for joint in model.joints if joint.nv == 1 and joint.name.startswith("panda/")]
        self._iq, self._iv = (np.array([getattr(joint, name) for joint in joints]) for name in ("iq", "iv"))
        self._drawer = model.joint(JOINT)
        start = world.q.copy()
        start[self._iq] = [*self.HOME, 0.04, 0.04]
        found = inverse_kinematics(model, HAND, self.START, self.LEVEL, start=start)
        world.q = self._home = found.q
        super().__init__(
            world, actions=4, observations=12, substeps=10, view=View((0.4, 0.0, 0.6), 1.5, -35, -20), **options
        )
        self._goal, self._target = np.zeros(3), self._home

    def begin(self) -> None:
        place = np.array([*self.draw_target(*self.PLACES), 0.0]) + self.CHEST
        self.world.set_body_pose("drawer/case", place, self.TURNED)
        self._goal, self._target = np.array(self.START), self._home

    def act(self, action: Array) -> None:
        goal = (self._goal + self.STRIDE * action[:3]).clip(*self.WORKSPACE)
        found = inverse_kinematics(self.model, HAND, goal, self.LEVEL, start=self._target, restarts=0)
        if found.success:  # else the hand waits where it can be
            self._goal, self._target = goal, found.q
        target, force = np.zeros((2, self.model.nv))
        target[self._iv] = [*self._target[self._iq[:7]], *[0.04 * (action[3] > 0)] * 2]
        force[self._iv] = self.MAX_FORCE * self.varied["motor_force"]
        self.world.set_motors(target_q=target, max_force=force)
        self.world.step(self.substeps)

    def look(self) -> Array:
        q, v = self.world.q, self.world.v
        hand, velocity = self.world.body_pose(HAND)[0], self.world.body_velocity(HAND)[1]
        rest = [q[self._iq[7:]].sum()], self.handle, [q[self._drawer.iq]], [v[self._drawer.iv]]
        return np.concatenate([hand, velocity, *rest])

    def judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        opening = float(self.world.q[self._drawer.iq])
        distance = float(np.linalg.norm(self.world.body_pose(HAND)[0] - self.handle))
        is_open = opening > self.OPEN
        return 10.0 * is_open + 5 * opening - distance, is_open, {"is_success": is_open, "opening": opening}

    @property
    def handle(self) -> Array:
        """The middle of the handle's bar (3) [m]."""
        position, quaternion = self.world.body_pose("drawer/drawer")
        return position + rotations.rotate(quaternion, np.array([0.204, 0.0, 0.07]))
