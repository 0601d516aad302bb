"""Quadrotors, one or several, that hover each at a place of its own."""

import math
from typing import Any

import numpy as np

from manyhands import rotations
from manyhands._core import World, asset_path, load_urdf
from manyhands.world_envs.world_env import Array, View, WorldEnv, marker

_OWN = 22  # numbers that a quadrotor observes of itself


class Rotors:
    """The four rotors of each of n quadrotors: in front, on the left, behind, on the right.

    A rotor at the speed w pulls with `THRUST` w^2 along its axis, and turns the craft with `DRAG` times that against
    its own turning. Its speed follows what is asked for with a time constant.
    """

    ARM = 0.175  # from the middle [m]
    THRUST = 3e-6  # [N s^2/rad^2]
    DRAG = 0.016  # torque per thrust [m]
    TIME_CONSTANT = 0.05  # [s]
    _TURNS = np.array([1.0, -1.0, 1.0, -1.0])  # of the craft by each rotor's drag, about z

    def __init__(self, world: World, links: list[str], time_step: float) -> None:
        self._world, self._links = world, links
        self._share = -math.expm1(-time_step / self.TIME_CONSTANT)
        weight = world.mass(links[0]) * 9.81
        self.hovering = math.sqrt(weight / 4 / self.THRUST)  # [rad/s]
        self.speeds = np.zeros((len(links), 4))  # [rad/s]

    def reset(self) -> None:
        """All turn as fast as hovering takes."""
        self.speeds = np.full_like(self.speeds, self.hovering)

    def step(self, commands: Array, strength: float = 1.0) -> None:
        """One step of the world; commands (n, 4) are wanted thrusts as shares of that of hovering. strength: factor
        on all thrusts, as of a battery that runs low."""
        wanted = self.hovering * np.sqrt(commands.clip(0, None))
        self.speeds = self.speeds + self._share * (wanted - self.speeds)
        for link, thrusts in zip(self._links, strength * self.THRUST * self.speeds**2, strict=True):
            front, left, behind, right = thrusts.tolist()
            torque = self.ARM * (left - right), self.ARM * (behind - front), self.DRAG * float(self._TURNS @ thrusts)
            quaternion = self._world.body_pose(link)[1]
            force = rotations.rotate(quaternion, np.array([0.0, 0.0, front + left + behind + right]))
            self._world.apply_force(link, force, rotations.rotate(quaternion, np.array(torque)))
        self._world.step()


class Quadrotors(WorldEnv):
    """n quadrotors of 0.5 kg that start anywhere about their places, and are to hover there.

    An action has four numbers for each, of its rotors in front, on the left, behind and on the right: -1 asks for no
    thrust, 0 for what hovers, 1 for twice that. Each observes 22 numbers, and three more for every other one: the way
    to its place (3), its rotation matrix (9), velocity (3), angular velocity (3), the thrusts of its rotors (4), the
    ways to the others. The reward is the mean of all: 1 at the place, half of that 0.3 m away, less for turning
    about. The episode is over when one leaves its place by 2 m, turns over, or touches something.
    """

    CENTRE = 0.0, 0.0, 1.0  # of all places [m]
    SPREAD = 0.3  # of all places together [m]
    START = 0.2  # how far from the middle of their places they start, along each axis [m]
    APART = 1.0  # from place to place [m]
    HALF = 0.3  # where half of the reward is left [m]
    LOST = 2.0  # [m]
    SUCCESS = 0.05  # [m]

    def __init__(self, drones: int = 1, **options: Any) -> None:
        """drones: how many. options: `render_mode` and `randomize`, see `WorldEnv`. Raises ValueError unless there is
        one at least."""
        if drones < 1:
            raise ValueError(f"drones is {drones}, expected 1 or more")
        self.drones = drones
        world = World(time_step=0.005)
        world.add_plane("floor")
        craft, _ = load_urdf(asset_path("bullet/Quadrotor/quadrotor.urdf"), fixed_base=False)
        for k in range(drones):
            world.add(craft, (0.0, self.APART * k, 1.0), name=f"drone{k}")
            world.add(marker(f"place{k}", 0.03))
        super().__init__(
            world,
            actions=4 * drones,
            observations=drones * (_OWN + 3 * (drones - 1)),
            substeps=4,
            view=View((0.0, 0.0, 0.95), 0.9 + 0.5 * drones, 70, -25),
            **options,
        )
        self._links = [f"drone{k}/base_link" for k in range(drones)]
        self._rotors = Rotors(world, self._links, world.time_step)
        self.places = np.zeros((drones, 3))

    def begin(self) -> None:
        row = np.arange(self.drones) - (self.drones - 1) / 2
        around = np.outer(row, [0.0, self.APART, 0.0])
        centre = np.array(self.CENTRE)
        self.places = self.draw_target(centre - self.SPREAD, centre + self.SPREAD) + around
        starts = centre + around + self.np_random.uniform(-self.START, self.START, (self.drones, 3))
        for k, link in enumerate(self._links):
            self.world.set_mocap(f"place{k}", self.places[k])
            self.world.set_body_pose(link, starts[k], rotations.from_euler(self.np_random.uniform(-0.2, 0.2, 3)))
        self._rotors.reset()

    def act(self, action: Array) -> None:
        for _ in range(self.substeps):
            self._rotors.step(1 + action.reshape(self.drones, 4), self.varied["motor_force"])

    def look(self) -> Array:
        poses = [self.world.body_pose(link) for link in self._links]
        thrusts = (self._rotors.speeds / self._rotors.hovering) ** 2
        rows = []
        for k, (position, quaternion) in enumerate(poses):
            turned = np.concatenate([rotations.rotate(quaternion, axis) for axis in np.eye(3)])  # columns of the matrix
            omega, velocity = self.world.body_velocity(self._links[k])
            ways = [other - position for i, (other, _) in enumerate(poses) if i != k]
            rows += [self.places[k] - position, turned, velocity, omega, thrusts[k], *ways]
        return np.concatenate(rows)

    def judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        distances, rewards, is_over = np.zeros(self.drones), np.zeros(self.drones), bool(self.world.contacts())
        for k, link in enumerate(self._links):
            position, quaternion = self.world.body_pose(link)
            omega, _ = self.world.body_velocity(link)
            distances[k] = np.linalg.norm(position - self.places[k])
            rewards[k] = 1 / (1 + (distances[k] / self.HALF) ** 2) - 0.02 * min(float(np.linalg.norm(omega)), 10.0)
            upward = rotations.rotate(quaternion, np.array([0.0, 0.0, 1.0]))[2]
            is_over = is_over or distances[k] > self.LOST or upward < 0
        info = {"is_success": bool((distances < self.SUCCESS).all()), "distances": distances, "rewards": rewards}
        return float(rewards.mean()), bool(is_over), info
