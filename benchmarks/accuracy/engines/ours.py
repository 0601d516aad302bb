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
TIGHT = "tolerance 1e-15"  # of the contact solver; a variant
NOT_FINITE = 1  # bit of Batch.flags
WORLDS = 16  # of the batch, all alike: its real-time factor counts them all


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


class OurSimulation(Simulation):
    """World.step, or Batch.step."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        super().__init__(scene, settings)
        model = self.model = mh.load_mjcf_string(mjcf(scene))[0]
        self.motors = np.zeros((5, model.nv))  # target, its rate, gains, force
        self.driven = False
        self.names = {body.name for body, _ in scene.walk()}
        self.lanes = settings.engine == LANES
        self.world: Any
        if self.lanes:
            self.world = mh.Batch(model, WORLDS, time_step=settings.time_step, num_threads=1)  # type: ignore[attr-defined]
        else:
            integrator: Any = settings.integrator or "semi_implicit"
            self.world = mh.World(model, time_step=settings.time_step, integrator=integrator)
        solver = dict(settings.options)
        if settings.variant == TIGHT:
            solver |= {"max_iterations": 1000, "tolerance": 1e-15}
        if settings.iterations is not None:
            solver["max_iterations"] = settings.iterations
        if solver:
            self.world.set_solver(**solver)
        for body, _ in scene.walk():
            if scene.restitution > 0 and body.geoms:
                self.world.set_restitution(body.name, scene.restitution)
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
        if self.forces:
            for _ in range(n):
                for name, (force, torque) in self.forces.items():
                    self.world.apply_force(name, force, torque)
                self.world.step(1)
        else:
            self.world.step(n)
        if self.lanes and np.any(np.asarray(self.world.flags) & NOT_FINITE):
            raise FloatingPointError(
                f"a world stopped before {self.time + n * self.time_step:.3g} s: numbers not finite"
            )

    def states(self, names: Sequence[str]) -> tuple[Array, Array, Array, Array]:
        rows = [(*self.world.body_pose(name), *self.world.body_velocity(name)) for name in names]
        p, quat, w, v = (np.array([self.row(row[k]) for row in rows]) for k in range(4))
        return p, quat, w, v

    def contacts(self) -> list[Contact]:
        if self.lanes:
            return []
        found = []
        for c in self.world.contacts():
            a, b = self.body_of(c.geom_a, c.link_a), self.body_of(c.geom_b, c.link_b)
            found.append(Contact(a, b, c.position, c.normal, c.distance, c.normal_force, c.friction_force))
        return found

    def body_of(self, geom: str, link: str) -> str:
        """Bodies fixed to the world may have become a part of it: their first geoms have their names."""
        return geom if geom in self.names else link

    @property
    def rtf(self) -> float:
        return super().rtf * (WORLDS if self.lanes else 1)

    def own_residuals(self) -> dict[str, float]:
        if self.lanes:
            return {}
        residuals = self.world.residuals()
        names = ("signorini", "penetration_rate", "cone", "dissipation")
        return {f"own {name}": float(getattr(residuals, name)) for name in names}
