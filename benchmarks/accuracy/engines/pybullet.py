"""PyBullet, built call by call from a scene: shapes, multibodies, constraints."""

from collections.abc import Sequence
from importlib import metadata
from typing import Any

import numpy as np

from benchmarks.accuracy.engines.base import CannotRunError, Contact, Settings, Simulation
from benchmarks.accuracy.quiet import quiet
from benchmarks.accuracy.scene import Array, Body, Geom, Scene, rotation

with quiet():  # it says when it was built
    import pybullet

# "defaults": 50 sweeps. "converged": four times as many, and none left out.
DEFAULTS = "defaults"
CONVERGED = "200 sweeps"
ANCHORS = "friction anchors"  # a spring that pulls a sticking point back; off by default
JOINTS = {
    "hinge": pybullet.JOINT_REVOLUTE,
    "slide": pybullet.JOINT_PRISMATIC,
    "ball": pybullet.JOINT_SPHERICAL,
    "fixed": pybullet.JOINT_FIXED,
}
NO_SHAPE = -1
BASE = -1


def version() -> str:
    """Of the wheel."""
    return metadata.version("pybullet")


def create(scene: Scene, settings: Settings) -> "BulletSimulation":
    """Raises CannotRunError for RK4."""
    if settings.integrator:
        raise CannotRunError(f"PyBullet has no integrator {settings.integrator}")
    return BulletSimulation(scene, settings)


class BulletSimulation(Simulation):
    """stepSimulation; forces and springs are given anew before every step, as PyBullet wants it."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        super().__init__(scene, settings)
        with quiet():
            self.client = pybullet.connect(pybullet.DIRECT)
        parameters: dict[str, Any] = {"restitutionVelocityThreshold": 0.0} if scene.restitution > 0 else {}
        if settings.variant == CONVERGED:
            parameters |= {"numSolverIterations": 200, "solverResidualThreshold": 0.0}
        if settings.iterations is not None:
            parameters |= {"numSolverIterations": settings.iterations, "solverResidualThreshold": 0.0}
        pybullet.setTimeStep(settings.time_step, self.client)
        pybullet.setGravity(*scene.gravity, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(**parameters | settings.options, physicsClientId=self.client)
        self.places: dict[str, tuple[int, int]] = {}  # body and link
        self.names: dict[tuple[int, int], str] = {}
        self.coms = {body.name: np.array(body.com) for body, _ in scene.walk()}
        for body in scene.bodies:
            self.add(body)
        for body in scene.moving():
            self.start(body)
        for loop in scene.loops:
            self.close(loop)
        for mimic in scene.mimics:
            self.couple(mimic)

    def __del__(self) -> None:
        if hasattr(self, "client"):
            pybullet.disconnect(self.client)

    def add(self, root: Body) -> None:
        """One multibody from a tree. A root with a joint other than free hangs from a base that never moves."""
        base = root if root.joint in ("free", "fixed") else None
        links: list[tuple[Body, int]] = []  # and the parent's number, 0 the base

        def gather(body: Body, parent: int) -> None:
            number = 0
            if body is not base:
                links.append((body, parent))
                number = len(links)
            for child in body.children:
                gather(child, number)

        gather(root, 0)
        bodies = [body for body, _ in links]
        index = pybullet.createMultiBody(
            baseMass=base.mass if base and base.joint == "free" else 0,
            baseCollisionShapeIndex=self.shape(base) if base else NO_SHAPE,
            basePosition=base.pos if base else (0, 0, 0),
            baseOrientation=base.quat if base else (0, 0, 0, 1),
            baseInertialFramePosition=base.com if base else (0, 0, 0),
            linkMasses=[body.mass for body in bodies],
            linkCollisionShapeIndices=[self.shape(body) for body in bodies],
            linkVisualShapeIndices=[NO_SHAPE] * len(links),
            linkPositions=[body.pos for body in bodies],
            linkOrientations=[body.quat for body in bodies],
            linkInertialFramePositions=[body.com for body in bodies],
            linkInertialFrameOrientations=[(0, 0, 0, 1)] * len(links),
            linkParentIndices=[parent for _, parent in links],
            linkJointTypes=[JOINTS[body.joint] for body in bodies],
            linkJointAxis=[body.axis for body in bodies],
            physicsClientId=self.client,
        )
        if base:
            self.places[base.name], self.names[index, BASE] = (index, BASE), base.name
        for k, body in enumerate(bodies):
            self.places[body.name], self.names[index, k] = (index, k), body.name
        whole = {
            "linearDamping": 0,
            "angularDamping": 0,
            "maxJointVelocity": 1e9,
        }  # a call that also has inertia drops it
        pybullet.changeDynamics(index, BASE, **whole, physicsClientId=self.client)
        for body in bodies if base is None else [base, *bodies]:
            self.describe(body)

    def shape(self, body: Body | None) -> int:
        """The collision shape of a body's geoms."""
        if body is None or len(body.geoms) == 0 or not self.scene.contacts:
            return NO_SHAPE
        if len(body.geoms) > 1:
            return self.boxes(body)
        (geom,) = body.geoms
        place = {"collisionFramePosition": geom.pos, "collisionFrameOrientation": geom.quat}
        return pybullet.createCollisionShape(**sizes(geom), **place, physicsClientId=self.client)

    def boxes(self, body: Body) -> int:
        """One shape of several boxes."""
        if any(geom.shape != "box" for geom in body.geoms):
            raise CannotRunError("the adapter for PyBullet makes bodies of several geoms from boxes only")
        return pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * len(body.geoms),
            halfExtents=[geom.size for geom in body.geoms],
            collisionFramePositions=[geom.pos for geom in body.geoms],
            collisionFrameOrientations=[geom.quat for geom in body.geoms],
            physicsClientId=self.client,
        )

    def describe(self, body: Body) -> None:
        """Inertia, damping and material: what the scene says."""
        index, link = self.places[body.name]
        values: dict[str, Any] = {"jointDamping": body.damping}
        if body.mass > 0:
            values["localInertiaDiagonal"] = body.moments
        if body.geoms:
            geom = body.geoms[0]
            values |= {"lateralFriction": geom.factor, "spinningFriction": geom.spin, "rollingFriction": geom.roll}
            values |= {"restitution": float(np.sqrt(self.scene.restitution))}
            if self.settings.variant == ANCHORS:
                values["frictionAnchor"] = 1
            if geom.shape == "hull":
                values["collisionMargin"] = 0.0
        pybullet.changeDynamics(index, link, **values, physicsClientId=self.client)

    def start(self, body: Body) -> None:
        """Initial state; PyBullet's default motors off."""
        index, link = self.places[body.name]
        here = {"physicsClientId": self.client}
        if body.joint == "free":
            pybullet.resetBaseVelocity(index, body.velocity, body.omega, **here)
        elif body.joint == "ball":
            pybullet.setJointMotorControlMultiDof(
                index, link, pybullet.POSITION_CONTROL, targetPosition=[0, 0, 0, 1], force=[0, 0, 0], **here
            )
        else:
            pybullet.resetJointState(index, link, body.q, body.v, **here)
            pybullet.setJointMotorControl2(index, link, pybullet.VELOCITY_CONTROL, force=0, **here)

    def close(self, loop: Any) -> None:
        """A point-to-point constraint; its frames are centres of mass."""
        first = self.places[loop.first]
        second = (-1, -1) if loop.second == "world" else self.places[loop.second]
        other = np.array(loop.other) - (0 if loop.second == "world" else self.coms[loop.second])
        constraint = pybullet.createConstraint(
            *first,
            *second,
            pybullet.JOINT_POINT2POINT,
            (0, 0, 0),
            list(np.array(loop.point) - self.coms[loop.first]),
            list(other),
            physicsClientId=self.client,
        )
        pybullet.changeConstraint(constraint, maxForce=1e9, physicsClientId=self.client)

    def couple(self, mimic: Any) -> None:
        """A gear, as PyBullet's own examples hold a gripper's fingers."""
        first, second = self.places[mimic.first], self.places[mimic.second]
        frames = ((0, 0, 0), (0, 0, 0))
        gear = pybullet.createConstraint(
            *first, *second, pybullet.JOINT_GEAR, (1, 0, 0), *frames, physicsClientId=self.client
        )
        pybullet.changeConstraint(gear, gearRatio=-1, erp=0.1, maxForce=50, physicsClientId=self.client)

    def advance(self, n: int) -> None:
        for _ in range(n):
            for motor in self.scene.motors:
                self.pull(motor)
            for name, (force, torque) in self.forces.items():
                index, link = self.places[name]
                pybullet.applyExternalForce(index, link, force, self.center(name), pybullet.WORLD_FRAME, self.client)
                if torque.any():
                    pybullet.applyExternalTorque(index, link, torque, pybullet.WORLD_FRAME, self.client)
            pybullet.stepSimulation(self.client)

    def drive(self, name: str, target: float, kp: float, kd: float, most: float) -> None:
        index, link = self.places[name]
        gains = {"targetPosition": target, "positionGain": kp, "velocityGain": kd, "force": most}
        pybullet.setJointMotorControl2(
            index, link, pybullet.POSITION_CONTROL, targetVelocity=0.0, **gains, physicsClientId=self.client
        )

    def spin(self, name: str, target: Array, kd: float, most: float) -> None:
        index, link = self.places[name]
        gains = {"targetPosition": [0, 0, 0, 1], "positionGain": 0.0, "velocityGain": kd, "force": [most] * 3}
        pybullet.setJointMotorControlMultiDof(
            index, link, pybullet.POSITION_CONTROL, targetVelocity=list(target), **gains, physicsClientId=self.client
        )

    def pull(self, motor: Any) -> None:
        """A position actuator as an explicit spring."""
        index, link = self.places[motor.body]
        q = pybullet.getJointState(index, link, self.client)[0]
        pybullet.setJointMotorControl2(
            index, link, pybullet.TORQUE_CONTROL, force=motor.kp * (motor.target - q), physicsClientId=self.client
        )

    def center(self, name: str) -> Any:
        """Of mass (3), in the world."""
        index, link = self.places[name]
        if link == BASE:
            return pybullet.getBasePositionAndOrientation(index, self.client)[0]
        return pybullet.getLinkState(index, link, 0, 1, self.client)[0]

    def states(self, names: Sequence[str]) -> tuple[Array, Array, Array, Array]:
        rows = [self.center_state(name) for name in names]
        c, quat, v, w = (np.array([row[k] for row in rows]) for k in range(4))
        arm = np.einsum("nij,nj->ni", rotation(quat), np.array([self.coms[name] for name in names]))
        return c - arm, quat, w, v - np.cross(w, arm)

    def center_state(self, name: str) -> tuple[Any, Any, Any, Any]:
        """Of the centre of mass: position, quaternion, linear and angular velocity."""
        index, link = self.places[name]
        if link == BASE:
            place = pybullet.getBasePositionAndOrientation(index, self.client)
            return *place, *pybullet.getBaseVelocity(index, self.client)
        center, quat, *_, v, w = pybullet.getLinkState(index, link, 1, 1, self.client)
        return center, quat, v, w

    def contacts(self) -> list[Contact]:
        found = []
        for c in pybullet.getContactPoints(physicsClientId=self.client):
            sliding = -(c[10] * np.array(c[11]) + c[12] * np.array(c[13]))
            a, b = self.names[c[1], c[3]], self.names[c[2], c[4]]
            found.append(Contact(a, b, np.array(c[6]), -np.array(c[7]), c[8], c[9], sliding))
        return found


def sizes(geom: Geom) -> dict[str, Any]:
    """A geom in createCollisionShape's words."""
    if geom.shape == "sphere":
        return {"shapeType": pybullet.GEOM_SPHERE, "radius": geom.size[0]}
    if geom.shape == "box":
        return {"shapeType": pybullet.GEOM_BOX, "halfExtents": geom.size}
    if geom.shape in ("capsule", "cylinder"):
        kind = pybullet.GEOM_CAPSULE if geom.shape == "capsule" else pybullet.GEOM_CYLINDER
        return {"shapeType": kind, "radius": geom.size[0], "height": 2 * geom.size[1]}
    if geom.shape == "plane":
        return {"shapeType": pybullet.GEOM_PLANE, "planeNormal": (0, 0, 1)}
    return {"shapeType": pybullet.GEOM_MESH, "vertices": [list(vertex) for vertex in geom.vertices]}
