"""The world behind the class PyBullet: bodies by name, their joints and saved states."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from manyhands import rotations
from manyhands._core import ModelBuilder, World
from manyhands._core import panda_gym as _core
from manyhands.panda_gym import bodies
from manyhands.panda_gym.bodies import Body, Pose
from manyhands.panda_gym.joints import Joints
from manyhands.rotations import Array


class error(Exception):  # noqa: N801, N818  the name it has in PyBullet
    """What cannot be done: an unknown state, link or joint, or anything once the simulation is closed."""


@dataclass
class SavedState:
    snapshot: bytes
    poses: dict[str, Pose]
    commands: Array


class Simulation:
    """Bodies have the names of their creation. Positions are in metres, world axes; links are PyBullet's indices."""

    def __init__(self, time_step: float) -> None:
        builder = ModelBuilder("simulation")
        builder.set_contact_rules(friction="product", restitution="product", self_collision=False)
        self.world = World(builder.build(), time_step)
        self.bodies: dict[str, Body] = {}
        self._joints = Joints(self.world)
        self._states: dict[int, SavedState] = {}
        self.before_each_step: Callable[[], None] | None = None
        """Called before each time step: who pushes bodies about does it there."""

    def step(self, n: int) -> None:
        """Advances by n time steps. The air slows free shapes; arms, which their motors hold, it does not."""
        self._joints.places()
        free = [body.links[0] for body in self.bodies.values() if body.is_free_shape]
        if self.before_each_step is None:
            _core.step(self.world, n, free)
            return
        for _ in range(n):
            self.before_each_step()
            _core.step(self.world, 1, free)

    def forget(self) -> None:
        """Joints are held where they are, and the solver starts cold: what follows depends on poses alone."""
        self._joints.hold()
        self.world.forget()

    # ---- bodies ------------------------------------------------------------------------------------------------

    def add_robot(self, name: str, path: Path, pose: Pose, fixed_base: bool) -> None:
        """A URDF file's robot, its root link's frame at `pose`."""
        self._require_new(name)
        model = bodies.load_robot(path, fixed_base)
        self.world.add(model, pose.position, pose.quaternion, name=name)
        self.bodies[name] = bodies.robot(name, model, bodies.load_robot(path, fixed_base=True), pose)
        self._world_has_changed()

    def add_shape(self, name: str, body: Body, builder: ModelBuilder | None) -> None:
        """What `bodies.shape` made."""
        self._require_new(name)
        if builder is not None:
            pose = body.pose or Pose(np.zeros(3), rotations.IDENTITY)
            self.world.add(builder, pose.position, pose.quaternion)
            self._world_has_changed()
        self.bodies[name] = body

    def link_name(self, body: str, link: int) -> str:
        """What the world calls a link. Raises error if there is none of that index."""
        names = self.bodies[body].links
        if not -1 <= link < len(names) - 1:
            raise error(f"body {body!r} has no link {link}; there are -1, the base, to {len(names) - 2}")
        return names[link + 1]

    def _require_new(self, name: str) -> None:
        if name in self.bodies:
            raise ValueError(f"there is a body {name!r} already; names must be unique")

    def _world_has_changed(self) -> None:
        self._joints.world_has_changed()

    # ---- where links are, and how they move ----------------------------------------------------------------------

    def frame(self, body: str, link: int) -> tuple[Array, Array]:
        """Position (3) and quaternion (4) of a link's frame."""
        name, pose = self.link_name(body, link), self.bodies[body].pose
        if link == -1 and pose is not None:
            return pose.position.copy(), pose.quaternion.copy()
        return self.world.body_pose(name)

    def center(self, body: str, link: int) -> tuple[Array, Array]:
        """Position (3) of a link's centre of mass, and the quaternion (4) of its frame."""
        position, quaternion = self.frame(body, link)
        com = self.bodies[body].coms[link + 1]
        return (position + rotations.rotate(quaternion, com) if com.any() else position), quaternion

    def velocity(self, body: str, link: int) -> tuple[Array, Array]:
        """Angular velocity (3) [rad/s] of a link, and the velocity (3) [m/s] of its centre of mass."""
        name, known = self.link_name(body, link), self.bodies[body]
        if link == -1 and known.pose is not None:
            return np.zeros(3), np.zeros(3)
        omega, velocity = self.world.body_velocity(name)
        com = known.coms[link + 1]
        if com.any():
            velocity = velocity + rotations.cross(omega, rotations.rotate(self.world.body_pose(name)[1], com))
        return omega, velocity

    def place(self, body: str, position: ArrayLike, quaternion: Array) -> None:
        """Puts the centre of a body's base somewhere, at rest."""
        known = self.bodies[body]
        position = np.array(position, np.float64).reshape(3) - rotations.rotate(quaternion, known.coms[0])
        if known.pose is not None:
            self._put(known, Pose(position, quaternion))
            return
        self.world.set_body_pose(known.links[0], position, quaternion)
        self.world.set_body_velocity(known.links[0])

    def _put(self, body: Body, pose: Pose) -> None:
        """Puts a body somewhere that does not move by itself."""
        assert body.pose is not None
        same = np.array_equal(pose.position, body.pose.position) and np.array_equal(
            pose.quaternion, body.pose.quaternion
        )
        if body.in_world and not same:
            self.world.set_body_pose(body.links[0], pose.position, pose.quaternion)
            self._world_has_changed()
        body.pose = pose

    # ---- joints --------------------------------------------------------------------------------------------------

    def joint_state(self, body: str, joint: int) -> tuple[float, float]:
        """Position [rad or m] and velocity; 0 of joints that are fixed or have several degrees of freedom."""
        place = self._place(body, joint)
        return (float(self.world.q[place[0]]), float(self.world.v[place[1]])) if place else (0.0, 0.0)

    def set_joints(self, body: str, joints: Iterable[int], angles: Iterable[float]) -> None:
        """Teleports joints, at rest; pairs them as far as the shorter goes."""
        q, v = self.world.q.copy(), self.world.v.copy()
        for joint, angle in zip(joints, angles, strict=False):
            place = self._place(body, int(joint))
            if place is not None:
                q[place[0]], v[place[1]] = angle, 0.0
        self.world.q, self.world.v = q, v

    def drive_joints(self, body: str, joints: ArrayLike, angles: ArrayLike, forces: ArrayLike) -> None:
        """Drives joints towards angles (n) with at most the forces (n); passes over those that cannot move."""
        rows = [np.asarray(numbers).reshape(-1) for numbers in (joints, angles, forces)]
        if len({len(row) for row in rows}) != 1:
            raise error("{} joints, {} target angles and {} forces: expected as many".format(*map(len, rows)))
        known = self._joints.places()
        moving = [
            (name, angle, force)
            for joint, angle, force in zip(*rows, strict=True)
            if (name := self._joint_name(body, int(joint))) in known
        ]
        names, targets, limits = zip(*moving, strict=True) if moving else ((), (), ())
        self._joints.drive(names, targets, limits)

    def drive(self, names: Iterable[str], angles: Sequence[float], forces: Sequence[float]) -> None:
        """The same of joints by their names in the world."""
        self._joints.drive(names, angles, forces)

    def movable_joints(self, body: str) -> list[int]:
        """The indices of the joints of one degree of freedom."""
        known = self._joints.places()
        return [i - 1 for i, name in enumerate(self.bodies[body].joints) if name in known]

    def reach(self, body: str, link: int, position: ArrayLike, quaternion: Array) -> Array:
        """PyBullet's inverse kinematics: positions of all movable joints that bring the link's frame closer to the
        pose, after 20 heavily damped updates without regard to limits."""
        known, name, movable = self.bodies[body], self.link_name(body, link), self.movable_joints(body)
        if known.model is None or name == known.links[0] or not movable:
            raise error(f"no joint of body {body!r} moves link {link}")
        p_WB, r_WB = self.frame(body, -1)
        to_base = rotations.conjugate(r_WB)
        place = {f"{body}/{joint.name}": joint.iq for joint in known.model.joints}
        places = [place[self._joint_name(body, joint)] for joint in movable]
        q = known.model.neutral_configuration()
        q[places] = [self.joint_state(body, joint)[0] for joint in movable]
        p_BL = rotations.rotate(to_base, np.asarray(position, np.float64) - p_WB)
        r_BL = rotations.multiply(to_base, quaternion)
        return _core.approach(known.model, name.removeprefix(f"{body}/"), p_BL, r_BL, q)[places]

    def _joint_name(self, body: str, joint: int) -> str:
        """What the world calls a joint; empty for one that is fixed. Raises error if there is none of that index."""
        self.link_name(body, joint)
        if joint < 0:
            raise error(f"body {body!r} has no joint {joint}")
        return self.bodies[body].joints[joint + 1] or ""

    def _place(self, body: str, joint: int) -> tuple[int, int] | None:
        return self._joints.places().get(self._joint_name(body, joint))

    # ---- friction ------------------------------------------------------------------------------------------------

    def touches(self, body: str, link: int) -> bool:
        """Whether a link is there and has a shape that collides."""
        known = self.bodies[body]
        if not known.in_world or not -1 <= link < len(known.links) - 1:
            return False
        model = self.world.model
        name = known.links[link + 1]
        return any(model.links[geom.link].name == name and not geom.is_visual for geom in model.geoms)

    # ---- states --------------------------------------------------------------------------------------------------

    def save(self) -> int:
        """Keeps all that moves and all poses; gives the smallest number that is not in use."""
        state = next(i for i in count() if i not in self._states)
        self._states[state] = self.state()
        return state

    def state(self) -> SavedState:
        """All that moves and all poses."""
        poses = {name: body.pose for name, body in self.bodies.items() if body.pose is not None}
        return SavedState(self.world.snapshot(), poses, self._joints.commands)

    def restore(self, state: int) -> None:
        """Raises error on an unknown number, or if bodies were added since."""
        saved = self._states.get(state)
        if saved is None:
            raise error(f"there is no saved state {state}; there are {sorted(self._states)}")
        try:
            self.go_back(saved)
        except ValueError as reason:
            raise error(f"state {state} was saved before bodies were added") from reason

    def go_back(self, saved: SavedState) -> None:
        """To what `state` gave. Raises ValueError if bodies were added since."""
        for name, pose in saved.poses.items():
            self._put(self.bodies[name], pose)
        self.world.restore(saved.snapshot)
        self._joints.commands = saved.commands

    def remove(self, state: int) -> None:
        """Passes over unknown numbers."""
        self._states.pop(state, None)
