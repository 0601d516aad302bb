"""What a page shows and drives."""

from abc import ABC, abstractmethod
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands import dynamics
from manyhands._core import Model, World
from manyhands.measures import rotate
from manyhands.viewer.joints import JointDrive

Array = NDArray[np.float64]
DragKey = Literal["cmd/ctrl"] | None


class Push(NamedTuple):
    """A force on a link, for as long as it is held."""

    link: str
    point: Array
    """(3) in the link's frame [m]."""
    force: Array
    """(3) in world axes [N]: of a spring, from the point to `target`."""
    target: Array
    """(3) where it is pulled to, in the world [m]."""


class Marker(NamedTuple):
    """A shape without a body: a goal."""

    name: str
    shape: str
    size: tuple[float, ...]
    rgba: tuple[float, ...]
    position: Array
    quaternion: Array


class Neighbours(NamedTuple):
    """n worlds of one model."""

    worlds: list[int]
    """Their numbers."""
    positions: Array
    """(n, links, 3) [m], each in its world."""
    quaternions: Array
    """(n, links, 4) xyzw"""
    markers: list[list[Marker]]
    """Goals of each world."""


class Source(ABC):
    """One world of bodies, and the clock that moves it.

    Everything is asked and told from one thread at a time.
    """

    title: str
    dt: float
    """What a `step` takes [s]."""
    world: World | None = None
    """Where forces and contacts are; None of environments in single precision, which are only watched."""
    joints: JointDrive | None = None
    """What moves the world's joints by hand; None without a world."""
    background: Array | None = None
    """A colour (3), 0 to 1, behind the scene; None: the page's own sky."""
    moves: bool = True
    """Whether the page moves it where no loop of the program's does."""
    drag_key: DragKey = "cmd/ctrl"
    """What is held to pull a body with the left button of the mouse; None: nothing."""
    only_watched: bool = False
    """Whether its program alone rules over time: the page neither pauses nor rewinds, and knows poses only."""
    rest: float = 0.0
    """How long the outcome of the last step is to be looked at [s] before the page makes another."""

    def __init__(self) -> None:
        self.pushes: dict[Any, Push] = {}

    @property
    @abstractmethod
    def model(self) -> Model: ...

    @property
    @abstractmethod
    def q(self) -> Array:
        """(nq)"""

    @property
    def mocap(self) -> Array | None:
        """Where mocap bodies are, as `World.mocap` has them; None: where the model has them."""
        return None

    @property
    @abstractmethod
    def time(self) -> float:
        """[s]"""

    @abstractmethod
    def step(self) -> None: ...

    @abstractmethod
    def reset(self) -> None: ...

    @abstractmethod
    def save(self) -> Any:
        """All that `restore` needs to go on from here with the same bits."""

    @abstractmethod
    def restore(self, state: Any) -> None: ...

    def markers(self) -> list[Marker]:
        """Goals and the like."""
        return []

    def neighbours(self) -> Neighbours | None:
        """Worlds that are drawn beside this one; None without any."""
        return None

    @property
    def can_be_pulled(self) -> bool:
        """Whether `pushes` move it."""
        return self.world is not None

    def refresh(self) -> None:  # noqa: B027  most sources are asked directly
        """Before what is shown is asked for."""

    def tick(self) -> None:  # noqa: B027  most sources know their time
        """Somebody else's loop has made a step."""

    def parts(self) -> tuple[Any, ...]:
        """Changes when bodies come or go."""
        model = self.model
        return (model.nq, *(link.name for link in model.links), len(model.geoms))

    def poses(self) -> tuple[Array, Array]:
        """Of the links: positions (n, 3), quaternions xyzw (n, 4)."""
        model = self.model
        positions, quaternions = dynamics.forward_kinematics(model, self.q)
        count = len(model.links)
        return positions[:count], quaternions[:count]

    def local(self, link: str, point: Array) -> Array:
        """A place in the world (3), as a link sees it."""
        index = next(i for i, each in enumerate(self.model.links) if each.name == link)
        positions, quaternions = self.poses()
        inverse = quaternions[index] * [-1, -1, -1, 1]
        return rotate(inverse, point - positions[index])

    def apply_pushes(self) -> None:
        """The forces that are held, for one time step of the world."""
        if self.world is not None:
            for push in list(self.pushes.values()):
                position, quaternion = self.world.body_pose(push.link)
                self.world.apply_force(push.link, push.force, point=position + rotate(quaternion, push.point))


class BodiesOfWorld(Source):
    """What sources with a world have in common."""

    def take(self, world: World, drive: JointDrive) -> None:
        """Shows a world from now on, whose joints are moved by a drive."""
        self.world, self.joints = world, drive
        self._world, self._drive = world, drive

    @property
    def model(self) -> Model:
        return self._world.model

    @property
    def q(self) -> Array:
        return self._world.q

    @property
    def mocap(self) -> Array | None:
        return self._world.mocap

    def poses(self) -> tuple[Array, Array]:
        return self._world.link_poses()

    @property
    def time(self) -> float:
        return self._world.time


class WorldSource(BodiesOfWorld):
    """A world that the page moves, or that somebody else moves and the page watches."""

    def __init__(self, world: World, title: str = "") -> None:
        super().__init__()
        self.take(world, JointDrive(world))
        self.dt = world.time_step
        self.title = title or world.model.name or "world"
        self._begin = world.snapshot()
        self._parts = self.parts()

    def step(self) -> None:
        self.apply_pushes()
        self._world.step()

    def reset(self) -> None:
        """To where the page found it, or to the model's own beginning if parts came or went since."""
        if self.parts() == self._parts:
            self._world.restore(self._begin)
        else:
            self._world.q = self.model.initial_configuration()
            self._world.v = np.zeros(self.model.nv)
        self._drive.release()

    def save(self) -> Any:
        return self._world.snapshot(), self._drive.save()

    def restore(self, state: Any) -> None:
        self._world.restore(state[0])
        self._drive.restore(state[1])


class SimulationSource(BodiesOfWorld):
    """The simulation under an environment of `manyhands.panda_gym`, its goals included."""

    def __init__(self, sim: Any, title: str = "simulation") -> None:
        """sim: a `manyhands.panda_gym.pybullet.PyBullet`."""
        super().__init__()
        self._sim, self._simulation = sim, sim.physics_client
        self.take(sim.world, JointDrive(sim.world, self._simulation.drive))
        self.title, self.dt, self.background = title, sim.dt, sim.background
        self._simulation.before_each_step = self.apply_pushes
        self._begin = self.save()

    def markers(self) -> list[Marker]:
        return [
            Marker(name, body.shape[0], body.shape[1], body.look.rgba, body.pose.position, body.pose.quaternion)
            for name, body in self._simulation.bodies.items()
            if not body.in_world and body.shape is not None
        ]

    def step(self) -> None:
        self._sim.step()

    def reset(self) -> None:
        """To where the page found it."""
        self.restore(self._begin)

    def save(self) -> Any:
        return self._simulation.state(), self._drive.save()

    def restore(self, state: Any) -> None:
        self._simulation.go_back(state[0])
        self._drive.restore(state[1])
