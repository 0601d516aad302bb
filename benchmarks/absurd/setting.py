"""What a family writes a scene into: MJCF text, and what is done to its world before and while it runs."""

import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import manyhands as mh
from benchmarks.absurd.draw import Array, Draw


def numbers(values: float | Iterable[float]) -> str:
    """As an attribute holds them."""
    return " ".join(f"{x:.17g}" for x in np.atleast_1d(np.asarray(values, float)))


def attributes(values: dict[str, Any]) -> str:
    """Numbers, arrays and words as attributes; what is None is left out."""
    words = {key: v if isinstance(v, str) else numbers(v) for key, v in values.items() if v is not None}
    return "".join(f" {key.rstrip('_')}='{word}'" for key, word in words.items())


def element(tag: str, inner: str = "", **values: Any) -> str:
    """One element of MJCF. A key of Python's own has a _ behind it."""
    return f"<{tag}{attributes(values)}>{inner}</{tag}>"


@dataclass
class Jump:
    """A mocap body put elsewhere before a step."""

    step: int
    body: str
    position: Array
    quaternion: Array  # xyzw


@dataclass
class Part:
    """A body that comes through the World's own functions."""

    kind: str  # box, mesh, cylinder or capsule
    name: str
    size: Array  # (3), of a mesh its points (n, 3)
    mass: float
    position: Array
    restitution: float
    fixed: bool

    def add_to(self, world: mh.World) -> None:
        """Adds it."""
        more: dict[str, Any] = {
            "position": self.position,
            "restitution": self.restitution,
            "fixed": self.fixed,
        }
        if self.kind == "box":
            world.add_box(self.name, self.size, self.mass, **more)
        elif self.kind == "mesh":
            world.add_mesh(self.name, self.size, self.mass, **more)
        elif self.kind == "cylinder":
            world.add_cylinder(self.name, self.size[0], self.size[1], self.mass, **more)
        else:
            world.add_capsule(self.name, self.size[0], self.size[1], self.mass, **more)


@dataclass
class Setting:
    """A scene in the making. Names within it are made by `name`, so that families mix."""

    draw: Draw
    world: list[str] = field(default_factory=list)
    assets: list[str] = field(default_factory=list)
    equalities: list[str] = field(default_factory=list)
    tendons: list[str] = field(default_factory=list)
    actuators: list[str] = field(default_factory=list)
    parts: list["Part"] = field(default_factory=list)
    angles: dict[str, float] = field(default_factory=dict)  # q by joint, of one dof each
    speeds: dict[str, Array] = field(default_factory=dict)  # v by joint
    jumps: list[Jump] = field(default_factory=list)
    ctrl: float = 1.0  # the largest command of actuators
    motors: float = 0.0  # the largest force of motors
    targets: Array = field(default_factory=lambda: np.zeros(0))  # (nv) of motors, and their largest forces, once built
    forces: Array = field(default_factory=lambda: np.zeros(0))
    gravity: Array = field(default_factory=lambda: np.array([0, 0, -9.81]))
    time_step: float = 0.002
    count: int = 0

    def name(self, kind: str) -> str:
        """One that is not taken."""
        self.count += 1
        return f"{kind}{self.count}"

    def text(self) -> str:
        """The MJCF file."""
        sections = {
            "asset": self.assets,
            "worldbody": self.world,
            "equality": self.equalities,
            "tendon": self.tendons,
            "actuator": self.actuators,
        }
        inner = "<compiler angle='radian' boundmass='0' boundinertia='0'/>"
        inner += element("option", timestep=self.time_step, gravity=self.gravity)
        inner += "".join(element(tag, "".join(lines)) for tag, lines in sections.items() if lines)
        return element("mujoco", inner)

    def build(self) -> mh.World:
        """The world at its start, once.

        Raises ValueError where the library refuses the scene, LoadWarning if it leaves a part of it out.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("error", mh.LoadWarning)
            model, _ = mh.load_mjcf_string(self.text())
        world = mh.World(model)
        for part in self.parts:
            part.add_to(world)
        self.start(world)
        return world

    def start(self, world: mh.World) -> None:
        """Sets q, v, commands and motors."""
        q, v = world.q.copy(), world.v.copy()
        for joint in world.model.joints:
            if joint.name in self.angles:
                q[joint.iq] = self.angles[joint.name]
            if joint.name in self.speeds:
                v[joint.iv : joint.iv + joint.nv] = self.speeds[joint.name]
        world.q, world.v = q, v
        rng = self.draw.rng
        world.ctrl = self.ctrl * rng.uniform(-1, 1, world.model.nu)
        if self.motors > 0:
            self.forces = np.full(world.model.nv, self.motors)
            for actuator in world.model.actuators:
                if actuator.joint >= 0:
                    self.forces[world.model.joints[actuator.joint].iv] = 0
            self.targets = rng.uniform(-3, 3, world.model.nv)
            world.set_motors(target_q=self.targets, kp=0.1, max_force=self.forces)

    def jumps_at(self, step: int) -> list[Jump]:
        """Those before that step."""
        return [jump for jump in self.jumps if jump.step == step]
