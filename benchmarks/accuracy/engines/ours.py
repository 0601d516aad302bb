"""manyhands: a World in double, or lane 0 of a Batch in float, on the MJCF of a scene."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import manyhands as mh
from benchmarks.accuracy.engines.base import CannotRunError, Contact, Settings, Simulation
from benchmarks.accuracy.mjcf import mjcf
from benchmarks.accuracy.scene import Array, Scene, rotation

LANES = "manyhands lanes"
WORLDS = 8  # of the batch, all alike


def version() -> str:
    """The extension's own bytes: a rebuilt one is another engine."""
    from manyhands import _core

    return hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()[:12]


def create(scene: Scene, settings: Settings) -> Simulation:
    """Raises CannotRunError for what the installed package lacks."""
    needed = "Batch" if settings.engine == LANES else "World"
    for name in ("load_mjcf_string", needed):
        if not hasattr(mh, name):
            raise CannotRunError(f"the installed manyhands has no {name}")
    if settings.engine == LANES and settings.integrator:
        raise CannotRunError(f"a Batch has no integrator {settings.integrator}")
    return OurSimulation(scene, settings)


def model_of(scene: Scene) -> Any:
    """The model, with the one thing that MJCF has no word for."""
    load: Any = mh.load_mjcf_string  # type: ignore[attr-defined]
    loaded = load(mjcf(scene), restitution=scene.restitution) if scene.restitution > 0 else load(mjcf(scene))
    return loaded[0] if isinstance(loaded, tuple) else loaded


class OurSimulation(Simulation):
    """World.step, or Batch.step."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        super().__init__(scene, settings)
        model = self.model = model_of(scene)
        self.motors = np.zeros((5, model.nv))  # target, its rate, gains, force
        self.driven = False
        self.lanes = settings.engine == LANES
        self.world: Any
        if self.lanes:
            self.world = mh.Batch(model, WORLDS, time_step=settings.time_step)  # type: ignore[attr-defined]
        else:
            integrator: Any = settings.integrator or "semi_implicit"
            self.world = mh.World(model, time_step=settings.time_step, integrator=integrator)
        solver = dict(settings.options)
        if settings.iterations is not None:
            solver["max_iterations"] = settings.iterations
        if solver:
            self.world.set_solver(**solver)
        q, v = self.row(self.world.q).copy(), self.row(self.world.v).copy()
        for body in scene.moving():
            joint = model.joint(body.name)
            if body.joint == "free":
                turned = rotation(body.quat).T
                v[joint.iv : joint.iv + 6] = [*(turned @ np.array(body.omega)), *(turned @ np.array(body.velocity))]
            elif body.joint != "ball":
                q[joint.iq], v[joint.iv] = body.q, body.v
        self.world.q, self.world.v = self.spread(q), self.spread(v)
        if scene.motors:
            self.world.ctrl = self.spread(np.array([motor.target for motor in scene.motors]))

    def row(self, values: Any) -> Array:
        """What lane 0 has, or the world."""
        return np.asarray(values[0] if self.lanes else values, float)

    def spread(self, values: Array) -> Any:
        """The same for every world of a batch."""
        return np.tile(values.astype(np.float32), (WORLDS, 1)) if self.lanes else values

    def drive(self, name: str, target: float, kp: float, kd: float, most: float) -> None:
        dof = self.model.joint(name).iv
        for values, value in zip(self.motors, (target, 0.0, kp, kd, most), strict=True):
            values[dof] = value
        self.driven = True

    def spin(self, name: str, target: Array, kd: float, most: float) -> None:
        dof = self.model.joint(name).iv
        for values, value in zip(self.motors, (np.zeros(3), target, 0.0, kd, most), strict=True):
            values[dof : dof + 3] = value
        self.driven = True

    def advance(self, n: int) -> None:
        if self.driven:
            names = ("target_q", "target_v", "kp", "kd", "max_force")
            motors = {name: self.spread(values) for name, values in zip(names, self.motors, strict=True)}
            self.world.set_motors(**motors)
            self.driven = False
        if not self.forces:
            self.world.step(n)
            return
        for _ in range(n):
            for name, (force, torque) in self.forces.items():
                self.world.apply_force(name, force, torque)
            self.world.step(1)

    def states(self, names: Sequence[str]) -> tuple[Array, Array, Array, Array]:
        rows = [(*self.world.body_pose(name), *self.world.body_velocity(name)) for name in names]
        p, quat, w, v = (np.array([self.row(row[k]) for row in rows]) for k in range(4))
        return p, quat, w, v

    def contacts(self) -> list[Contact]:
        if self.lanes:
            return []
        found = []
        for c in self.world.contacts():
            normal, force = np.asarray(c.normal, float), np.asarray(c.force, float)
            along = float(normal @ force)
            found.append(
                Contact(c.link_a, c.link_b, np.asarray(c.position), normal, c.distance, along, force - along * normal)
            )
        return found

    def own_residuals(self) -> dict[str, float] | None:
        residuals = self.world.residuals()
        return {name: float(np.max(getattr(residuals, name))) for name in ("signorini", "cone", "dissipation")}
