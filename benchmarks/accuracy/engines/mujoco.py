"""MuJoCo, on the MJCF of a scene."""
# pyright: reportAttributeAccessIssue=false
# The stubs of the wheel leave out what its extension defines.

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from benchmarks.accuracy.engines.base import CannotRunError, Contact, Settings, Simulation
from benchmarks.accuracy.mjcf import Options, mjcf
from benchmarks.accuracy.scene import Array, Scene, rotation

# "recommended": what its documentation advises against slip. "stiff": as hard as the step allows (a contact's time
# constant must be two steps or more), and slip removed afterwards by the noslip solver.
RECOMMENDED = "elliptic, impratio 10"
STIFF = "stiff, noslip 10"
NOSLIP = "elliptic, noslip 10"
DEFAULTS = "defaults"


def version() -> str:
    """Of the package."""
    return mujoco.__version__


def options_of(settings: Settings) -> Options:
    """The contact model and solver of a variant, with what the case adds."""
    h = settings.time_step
    options = Options(time_step=h, servos=True)
    if settings.variant == DEFAULTS:
        options = replace(options, cone="pyramidal", integrator="Euler")
    elif settings.variant == STIFF:
        options = replace(
            options,
            impratio=10,
            noslip=10,
            solref=f"{2 * h!r} 1",
            solimp="0.99 0.999 0.0001",
            loop_solref=f"{2 * h!r} 1",
        )
    else:
        options = replace(options, impratio=10, noslip=10 if settings.variant == NOSLIP else 0)
    if settings.integrator:
        options = replace(options, integrator={"rk4": "RK4"}.get(settings.integrator, settings.integrator))
    if settings.iterations is not None:
        options = replace(options, iterations=settings.iterations)
    return replace(options, **settings.options)


def create(scene: Scene, settings: Settings) -> "MujocoSimulation":
    """Raises CannotRunError for restitution, unless the case gives elastic contacts by `solref`."""
    if scene.restitution > 0 and not str(settings.options.get("solref", "")).startswith("-"):
        raise CannotRunError("MuJoCo has no coefficient of restitution")
    return MujocoSimulation(scene, settings)


class MujocoSimulation(Simulation):
    """mj_step, and kinematics before reading."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        super().__init__(scene, settings)
        self.model = mujoco.MjModel.from_xml_string(mjcf(scene, options_of(settings)))
        self.data = mujoco.MjData(self.model)
        self.ids = {body.name: self.model.body(body.name).id for body, _ in scene.walk()}
        for body in scene.moving():
            joint = self.model.joint(body.name)
            q, v = int(joint.qposadr[0]), int(joint.dofadr[0])
            if body.joint == "free":
                self.data.qvel[v : v + 3] = body.velocity
                self.data.qvel[v + 3 : v + 6] = rotation(body.quat).T @ np.array(body.omega)
            elif body.joint != "ball":
                self.data.qpos[q], self.data.qvel[v] = body.q, body.v
        for k, motor in enumerate(scene.motors):
            self.data.ctrl[k] = motor.target
        self.stale = True
        self.servos = {servo.body: len(scene.motors) + k for k, servo in enumerate(scene.servos)}

    def drive(self, name: str, target: float, kp: float, kd: float, most: float) -> None:
        if name not in self.servos:
            super().drive(name, target, kp, kd, most)
        self.data.ctrl[self.servos[name]] = target

    def advance(self, n: int) -> None:
        mujoco.mj_step(self.model, self.data, nstep=n)
        self.stale = True

    def set_force(self, body: str, force: Sequence[float] | Array, torque: Sequence[float] | Array = (0, 0, 0)) -> None:
        super().set_force(body, force, torque)
        self.data.xfrc_applied[self.ids[body]] = np.concatenate(self.forces[body])

    def states(self, names: Sequence[str]) -> tuple[Array, Array, Array, Array]:
        if self.stale:
            mujoco.mj_kinematics(self.model, self.data)
            mujoco.mj_comPos(self.model, self.data)
            mujoco.mj_comVel(self.model, self.data)
            self.stale = False
        ids = np.array([self.ids[name] for name in names])
        p = self.data.xpos[ids]
        w = self.data.cvel[ids, :3]
        from_com = p - self.data.subtree_com[self.model.body_rootid[ids]]
        v = self.data.cvel[ids, 3:] + np.cross(w, from_com)
        return p, np.roll(self.data.xquat[ids], -1, axis=1), w.copy(), v

    def contacts(self) -> list[Contact]:
        found, force = [], np.zeros(6)
        names = [self.model.body(k).name for k in range(self.model.nbody)]
        for k in range(self.data.ncon):
            contact = self.data.contact[k]
            mujoco.mj_contactForce(self.model, self.data, k, force)
            frame = contact.frame.reshape(3, 3)
            a, b = (names[self.model.geom_bodyid[g]] for g in contact.geom)
            sliding = force[1] * frame[1] + force[2] * frame[2]
            found.append(Contact(a, b, contact.pos.copy(), frame[0].copy(), contact.dist, force[0], sliding))
        return found
