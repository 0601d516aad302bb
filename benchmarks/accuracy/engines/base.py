"""What a case may ask of an engine."""

import importlib
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from benchmarks.accuracy.scene import Array, Scene, rotation

MODULES = {"manyhands": "ours", "manyhands lanes": "ours", "MuJoCo": "mujoco", "PyBullet": "pybullet"}


class CannotRunError(Exception):
    """This engine cannot run this case; the text says why."""


class OutOfTimeError(Exception):
    """The run has spent its processor time."""


@dataclass(frozen=True)
class Settings:
    """One way to run one case."""

    engine: str
    time_step: float
    iterations: int | None = None  # None: the engine's default
    variant: str = ""  # of the engine's settings
    integrator: str = ""  # "" or "rk4"
    budget: float = 60.0  # processor seconds
    options: dict[str, Any] = field(default_factory=dict, compare=False)  # per engine, from the case


class Contact(NamedTuple):
    """One point; the force acts on B."""

    body_a: str
    body_b: str
    position: Array  # (3)
    normal: Array  # (3) from A to B
    distance: float  # negative in penetration
    normal_force: float
    friction_force: Array  # (3)


class Simulation(ABC):
    """A scene in an engine. Poses and velocities are those after the last step, of bodies' origins, in world axes."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        self.scene, self.settings = scene, settings
        self.time_step = settings.time_step
        self.spent = 0.0  # processor seconds in steps
        self.steps = 0
        self.forces: dict[str, tuple[Array, Array]] = {}  # (force, torque) at the centre of mass, until changed

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self.steps * self.time_step

    @property
    def rtf(self) -> float:
        """Simulated seconds per second of the processor, of steps alone."""
        return self.time / max(self.spent, 1e-9)

    def step(self, n: int = 1) -> None:
        """Advances by n steps; raises OutOfTimeError once the budget is spent."""
        if self.spent > self.settings.budget:
            raise OutOfTimeError(f"stopped at {self.time:.3g} s, after {self.spent:.0f} s of the processor")
        start = time.process_time()
        self.advance(n)
        self.spent += time.process_time() - start
        self.steps += n

    def run(self, seconds: float, every: float = 0.016, look: Callable[[], None] | None = None) -> None:
        """Advances by `seconds`, and looks each time another `every` seconds are over."""
        total, piece = round(seconds / self.time_step), max(1, round(every / self.time_step))
        for start in range(0, total, piece):
            self.step(min(piece, total - start))
            if look is not None:
                look()

    def set_force(self, body: str, force: Sequence[float] | Array, torque: Sequence[float] | Array = (0, 0, 0)) -> None:
        """A force at the centre of mass of a body, and a torque, until they are set again; world axes."""
        self.forces[body] = (np.asarray(force, float), np.asarray(torque, float))

    @abstractmethod
    def states(self, names: Sequence[str]) -> tuple[Array, Array, Array, Array]:
        """Positions (n, 3), quaternions (n, 4), angular (n, 3) and linear (n, 3) velocities."""

    def position(self, name: str) -> Array:
        """(3) [m]"""
        return self.states([name])[0][0]

    def turn(self, name: str) -> Array:
        """(3, 3) from body to world."""
        return rotation(self.states([name])[1][0])

    def drive(self, name: str, target: float, kp: float, kd: float, most: float) -> None:
        """A motor as PyBullet's on a hinge or slide, from now on: gains are fractions per step, `most` its force."""
        raise CannotRunError(f"{self.settings.engine} has no motor at the velocity level")

    def spin(self, name: str, target: Array, kd: float, most: float) -> None:
        """The same on a ball joint, for the velocity (3) in its own axes alone."""
        raise CannotRunError(f"{self.settings.engine} has no motor at the velocity level")

    @abstractmethod
    def advance(self, n: int) -> None:
        """The engine's steps, and nothing else: they are timed."""

    @abstractmethod
    def contacts(self) -> list[Contact]:
        """Of the last step."""

    def own_residuals(self) -> dict[str, float]:
        """What the engine says of its own solution, if it does."""
        return {}


def build(scene: Scene, settings: Settings) -> Simulation:
    """The engine's simulation of a scene. Raises Cannot."""
    module = importlib.import_module(f"benchmarks.accuracy.engines.{MODULES[settings.engine]}")
    return module.create(scene, settings)


def version(engine: str) -> str:
    """What was measured; "" if it is not installed."""
    try:
        return importlib.import_module(f"benchmarks.accuracy.engines.{MODULES[engine]}").version()
    except ImportError:
        return ""
