"""Arms, grippers and furniture that ship with the package, and what puts a gripper on an arm.

    arm = robots.load("six_axis", gripper="parallel")
    world.add(arm, name="arm")  # starts at home, its gripper open

Names are of a kind, not of a maker's product; docs/robots.md shows them. All is written by tools/make_robots.py.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, ModelBuilder, World, asset_path, envs, load_urdf
from manyhands.arguments import brief, choice, finite_row, instance, number
from manyhands.ik import inverse
from manyhands.measures import chain, hand_of
from manyhands.planning.trajectories import quintic

__all__ = ["Arm", "Description", "Vacuum", "attach", "describe", "load", "names", "path", "split"]

GRIPPER = "gripper/"
OF_ENVIRONMENTS = ("panda", "arm6")
"""The arms of the environments, each with its hand: `load` and the like know them, too."""

Pose: TypeAlias = tuple[ArrayLike, ArrayLike]
Array: TypeAlias = NDArray[np.float64]

_PACE = 0.5  # of the speeds that joints may have
_SPEED = 1.0  # [rad/s or m/s] that joints may have whose model names none
_QUINTIC_PEAK = 1.875  # the highest speed of a quintic from rest to rest, in mean ones
_SHORTEST = 0.25  # [s] of a motion
_LONGEST = 3600.0  # [s]
_SETTLING = 0.5  # [s] after a motion, for motors that fell behind
_NEAR = 2e-3  # [m] from where it was to go that a hand has arrived
_ALIGNED = 0.02  # [rad]


@dataclass(frozen=True)
class Description:
    """What the catalogue says of a robot; names are those of its file."""

    kind: str
    """One of "arm", "gripper" and "furniture"."""
    about: str
    """In a line."""
    home: Mapping[str, float] = field(default_factory=dict)
    """Position of each joint that no other drives [rad or m]; of a gripper, open."""
    flange: str = ""
    """The link where a gripper goes, z outwards; empty if there is none."""
    tool: str = ""
    """The link between the fingers, z outwards; empty if there is none."""
    closed: Mapping[str, float] = field(default_factory=dict)
    """Where the joint that drives the fingers closes them [rad or m]."""
    width: tuple[float, float] = (0.0, 0.0)
    """Of a gripper, between its fingers at the tool, closed and open; of three, twice their distance from z [m]."""
    payload: float = 0.0
    """What the motors hold in any posture, at the flange or tool; of a gripper, between its fingers [kg]."""


def names(kind: str | None = None) -> list[str]:
    """All robots, or those of a kind: "arm", "gripper", "furniture". Raises ValueError on an unknown kind."""
    kinds = list(dict.fromkeys(robot.kind for robot in _catalogue().values()))
    if kind is not None:
        choice("kind", kind, *kinds)
    return [name for name, robot in _catalogue().items() if kind in (None, robot.kind)]


def describe(name: str) -> Description:
    """What the catalogue says of a robot. Raises ValueError on an unknown name."""
    if instance("name", name, str) in OF_ENVIRONMENTS:
        arm = envs.arm_spec(name)
        return Description("arm", "arm of the environments, with its hand", home=arm.home, tool=arm.hand)
    if name in _catalogue():
        return _catalogue()[name]
    known = ", ".join([*_catalogue(), *OF_ENVIRONMENTS])
    raise ValueError(f"there is no robot {name!r}; there are {known}")


def path(name: str) -> Path:
    """The robot's URDF file. Raises ValueError on an unknown name."""
    describe(name)
    return asset_path(f"{name if name in OF_ENVIRONMENTS else 'robots'}/{name}.urdf")


def load(name: str, *, gripper: str | None = None, fixed_base: bool = True) -> Model:
    """A robot that starts at home, with a gripper on its flange if one is named, here or as "six_axis+parallel".

    "panda" and "arm6", the arms of the environments, have a hand of their own. A gripper's parts are called
    'gripper/part', so its tool is 'gripper/tool'. fixed_base: False lets the robot float: a bin that can be carried.
    Raises ValueError on an unknown name, two grippers, and a gripper where there is no flange.
    """
    name, named = split(instance("name", name, str))
    if gripper is not None:
        instance("gripper", gripper, str)
    if named and gripper is not None:
        raise ValueError(f"both {named!r} and {gripper!r} are to go on the flange of {name}; name one gripper")
    gripper = gripper or named
    robot = describe(name)
    model, _ = load_urdf(path(name), fixed_base=fixed_base)
    builder = ModelBuilder.of(model)
    for joint, value in robot.home.items():
        builder.set_initial(joint, [value])
    model = builder.build()
    if gripper is None:
        return model
    if not robot.flange:
        raise ValueError(f"{name} has no flange for a gripper; {', '.join(_with_flange())} have")
    return attach(model, gripper, robot.flange)


def split(text: str) -> tuple[str, str | None]:
    """The arm and the gripper of 'six_axis+two_finger', with or without blanks; None where only one is named."""
    name, _, gripper = instance("text", text, str).partition("+")
    return name.strip(), gripper.strip() or None


def attach(arm: Model, gripper: str | Model, frame: str, *, prefix: str = GRIPPER) -> Model:
    """The arm with a gripper, by its name here or any model, fixed in a link or frame of it.

    The gripper's world frame comes to lie in `frame`, z away from the arm; names of its parts follow `prefix`.
    Raises ValueError on an unknown gripper or frame and on names that are taken.
    """
    if isinstance(gripper, str) and gripper not in (grippers := names("gripper")):
        raise ValueError(f"there is no gripper {gripper!r}; there are {', '.join(grippers)}")
    builder = ModelBuilder.of(arm)
    builder.add_model(load(gripper) if isinstance(gripper, str) else gripper, frame=frame, prefix=prefix)
    return builder.build()


class Arm:
    """An arm in a world, moved by where its hand is to be.

        arm = robots.Arm(world, "arm/gripper/tool")
        arm.go_to([0.4, 0.1, 0.9])

    hand: the link's name in the world; by default the first that looks like a tool or a hand. Raises KeyError if there
    is no such link, ValueError if no joints of one degree of freedom lead to it.
    """

    def __init__(self, world: World, hand: str | None = None) -> None:
        instance("world", world, World)
        hand = hand_of(world.model) if hand is None else hand
        if hand is None:
            raise ValueError("nothing in this world looks like a hand; name the link that is to go somewhere")
        world.model.link(hand)
        joints = chain(world.model, hand)
        if not joints:
            raise ValueError(f"no joints, or one of several degrees of freedom, lead to {hand!r}")
        self.world, self.hand, self.joints = world, hand, joints

    @property
    def pose(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where the hand is: position (3) [m] and quaternion xyzw (4), in the world."""
        return self.world.body_pose(self.hand)

    def go_to(
        self, pose: ArrayLike | Pose, *, seconds: float | None = None, on_step: Callable[[], object] | None = None
    ) -> None:
        """Steps the world until the hand has gone to a pose, by motors as `World.move` sets them, which hold it there.

        pose: (position (3) [m], quaternion xyzw (4)) in the world, as `World.body_pose` gives them; or a position
        alone, and the hand stays as it is turned. Joints move together, smoothly, and straight from configuration to
        configuration: what lies between is not looked at (`planning.Planner` does).
        seconds: how long it takes; by default as long as joints need at half the speeds that their model allows. Motors
        that fall behind get half a second more.
        on_step: called after each step, as `viewer.sync`.
        Raises ValueError, and nothing moves, if the arm does not reach the pose, or not so fast, or something else
        drives its joints; RuntimeError if the hand does not arrive, to 2 mm and 0.02 rad, and stands where it got to.
        """
        model = self.world.model
        if on_step is not None and not callable(on_step):
            raise TypeError(f"on_step is {brief(on_step)}; expected a function without arguments")
        given, turned = pose if isinstance(pose, tuple | list) and len(pose) == 2 else (pose, self.pose[1])
        at, turned = finite_row("position", given, 3), finite_row("quaternion", turned, 4)
        start = np.asarray(self.world.q)
        found = inverse(model, self.hand, position=at, quaternion=turned, start=start)
        if not found.success:
            turned_off = np.degrees(float(found.rotation_error))
            off = f"{1e3 * float(found.position_error):.0f} mm and {turned_off:.0f} degrees"
            place = np.round(at, 3).tolist()
            raise ValueError(f"{self.hand} does not reach {place}: the nearest that was found is {off} off")
        joints = [model.joint(name) for name in self.joints]
        places, h = [joint.iq for joint in joints], self.world.time_step
        begin = np.clip(start[places], [joint.lower for joint in joints], [joint.upper for joint in joints])
        end = found.q[places]
        lasts = self._duration(end - begin, seconds)
        motion = quintic([0.0, lasts], [begin, end])
        for q in [*motion.sample(np.arange(h, lasts, h)).q, end]:
            self._drive(q, on_step)
        for _ in range(int(_SETTLING / h)):
            if self._off(at, turned) == "":
                return
            self._drive(end, on_step)
        if off := self._off(at, turned):
            raise RuntimeError(f"{self.hand} did not arrive: it is {off} off; {self._hindrance()}")

    def _duration(self, way: Array, seconds: float | None) -> float:
        """How long joints take for a way (n,) [s]. Raises ValueError if that is more than what is given."""
        speeds = np.array([self.world.model.joint(name).velocity for name in self.joints])
        if seconds is None:
            paced = _PACE * np.where(np.isfinite(speeds), speeds, _SPEED)
            return max(_SHORTEST, float(np.max(_QUINTIC_PEAK * np.abs(way) / paced)))
        given, least = number("seconds", seconds, above=0, most=_LONGEST), _QUINTIC_PEAK * np.abs(way) / speeds
        slowest = int(np.argmax(least))
        if given < least[slowest]:
            joint = self.joints[slowest]
            raise ValueError(f"seconds is {given:g}; {joint!r} needs {least[slowest]:.3g} s at the speed of its model")
        return given

    def _drive(self, q: Array, on_step: Callable[[], object] | None) -> None:
        self.world.move(dict(zip(self.joints, q.tolist(), strict=True)), kp=1.0)
        self.world.step()
        if on_step is not None:
            on_step()

    def _off(self, position: Array, quaternion: Array) -> str:
        """How far the hand is from a pose, in words; none if it is there."""
        at, turned = self.pose
        cosine = abs(turned @ quaternion) / np.linalg.norm(quaternion)
        far, angle = float(np.linalg.norm(at - position)), 2 * float(np.arccos(min(1.0, cosine)))
        return "" if far < _NEAR and angle < _ALIGNED else f"{1e3 * far:.0f} mm and {np.degrees(angle):.0f} degrees"

    def _hindrance(self) -> str:
        """What presses hardest on the links that the joints move, in words."""
        model, joints = self.world.model, set(self.joints)
        own = {link.name for link in model.links if joints & set(chain(model, link.name))}
        touched = [touch for touch in self.world.contacts() if len(own & {touch.link_a, touch.link_b}) == 1]
        if not touched:
            return "nothing touches it, so its motors are too weak for what they carry, or too slow"
        hardest = max(touched, key=lambda touch: touch.normal_force)
        return f"{hardest.link_a!r} and {hardest.link_b!r} touch"


class Vacuum:
    """A suction cup in a world: holds what it touches, as a weld, until it is turned off.

    cup: the link's name there, 'arm/gripper/cup'. The weld knows no limit of force; `describe("vacuum").payload` says
    what such a cup may lift. Raises KeyError if there is no such link.
    """

    def __init__(self, world: World, cup: str) -> None:
        instance("world", world, World).model.link(cup)
        self._world, self._cup, self._weld = world, cup, ""

    def on(self, *, reach: float = 0.003) -> str | None:
        """Takes hold of the nearest link within `reach` [m] of the cup; its name, or None if there is none.

        Holds on to what it has already, and returns None. Raises KeyError if there is no such cup.
        """
        near = self._world.near_links(number("reach", reach, least=0), self._cup)
        if self._weld or not near:
            return None
        nearest = min(near, key=lambda pair: pair.phi)
        held = nearest.link_b if nearest.link_a == self._cup else nearest.link_a
        self._weld = self._world.weld(self._cup, held)
        return held

    def off(self) -> None:
        """Lets go, if it holds something."""
        if self._weld:
            self._world.unweld(self._weld)
            self._weld = ""

    @property
    def holds(self) -> bool:
        """Whether it has hold of something."""
        return bool(self._weld)


@cache
def _catalogue() -> dict[str, Description]:
    entries = json.loads(asset_path("robots/catalogue.json").read_text(encoding="utf-8"))
    return {
        name: Description(**entry | {"width": tuple(entry.get("width", (0.0, 0.0)))}) for name, entry in entries.items()
    }


def _with_flange() -> list[str]:
    return [name for name, robot in _catalogue().items() if robot.flange]
