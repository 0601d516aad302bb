"""What is measured on any engine from poses and velocities: energy, momentum, depth, residuals of the contact law."""

from collections.abc import Sequence

import numpy as np

from benchmarks.accuracy.engines.base import Simulation
from benchmarks.accuracy.scene import Array, Body, Scene, rotation


class Mass:
    """The bodies that move, and what is summed over them."""

    def __init__(self, scene: Scene) -> None:
        self.bodies = scene.moving()
        self.names = [body.name for body in self.bodies]
        self.mass = np.array([body.mass for body in self.bodies])
        self.com = np.array([body.com for body in self.bodies])
        self.moments = np.array([body.moments for body in self.bodies])
        self.gravity = np.array(scene.gravity)

    def centers(self, sim: Simulation) -> tuple[Array, Array, Array, Array]:
        """Centres of mass (n, 3), rotations (n, 3, 3), angular velocities, velocities of the centres (n, 3)."""
        p, quat, w, v = sim.states(self.names)
        R = rotation(quat)
        arm: Array = np.einsum("nij,nj->ni", R, self.com)
        return p + arm, R, w, v + np.cross(w, arm)

    def energy(self, sim: Simulation) -> float:
        """Kinetic and potential [J]."""
        c, R, w, v = self.centers(sim)
        local = np.einsum("nji,nj->ni", R, w)
        kinetic = 0.5 * self.mass @ (v * v).sum(1) + 0.5 * (self.moments * local**2).sum()
        return float(kinetic - self.mass @ (c @ self.gravity))

    def momentum(self, sim: Simulation) -> Array:
        """Linear (3) [kg m/s]."""
        return self.mass @ self.centers(sim)[3]

    def spin(self, sim: Simulation) -> Array:
        """Angular momentum (3) about the world's origin [kg m^2/s]."""
        c, R, w, v = self.centers(sim)
        own = np.einsum("nij,nj->ni", R, self.moments * np.einsum("nji,nj->ni", R, w))
        return (own + np.cross(c, self.mass[:, None] * v)).sum(0)


def corners(size: Sequence[float]) -> Array:
    """Of a box (8, 3)."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    return signs * np.array(size)


def placed(p: Array, quat: Array, points: Array) -> Array:
    """Points of a body in the world (k, 3)."""
    return p + points @ rotation(quat).T


def friction_of(scene: Scene, first: Body, second: Body) -> float:
    """Of a pair: its own, or the larger of the two."""
    for pair in scene.pairs:
        if {pair.first, pair.second} == {first.name, second.name}:
            return pair.friction
    return max(first.geoms[0].friction, second.geoms[0].friction)


def residuals(sim: Simulation, steps: int = 5) -> dict[str, float]:
    """Largest residuals of the contact law over some steps, from the engine's contacts and the bodies' motion.

    signorini: |gap| x normal force [N m]. cone: friction beyond mu x normal force [N]. dissipation: by how much sliding
    friction misses the power mu x normal force x speed [W]. balance: a free body's change
    of momentum against its forces [N].
    Those named "own" are the engine's, at the velocity level. After Le Lidec et al., Contact Models in Robotics (2023).
    """
    bodies = {body.name: body for body, _ in sim.scene.walk()}
    free = {name: body for name, body in bodies.items() if body.joint == "free"}
    worst = {"signorini": 0.0, "cone": 0.0, "dissipation": 0.0, "balance": 0.0}
    moving = [body.name for body in sim.scene.moving()]
    h = sim.time_step
    for _ in range(steps):
        before, _, _, v0 = sim.states(moving)
        sim.step()
        _, _, w1, v1 = sim.states(moving)
        index = {name: k for k, name in enumerate(moving)}
        forces = {name: np.zeros(3) for name in free}
        contacts = sim.contacts()
        if not contacts:
            return {}

        def velocity(name: str, point: Array, at: dict[str, int] = index, p=before, w=w1, v=v1) -> Array:
            k = at.get(name)
            return np.zeros(3) if k is None else v[k] + np.cross(w[k], point - p[k])

        for c in contacts:
            total = c.normal_force * c.normal + c.friction_force
            for name, sign in ((c.body_a, -1), (c.body_b, 1)):
                if name in forces:
                    forces[name] += sign * total
            mu = friction_of(sim.scene, bodies[c.body_a], bodies[c.body_b])
            slip = velocity(c.body_b, c.position) - velocity(c.body_a, c.position)
            slip = slip - (slip @ c.normal) * c.normal
            most = mu * c.normal_force
            worst["signorini"] = max(worst["signorini"], abs(c.distance) * c.normal_force)
            worst["cone"] = max(worst["cone"], float(np.linalg.norm(c.friction_force)) - most)
            lost = most * float(np.linalg.norm(slip)) + float(c.friction_force @ slip)
            worst["dissipation"] = max(worst["dissipation"], abs(lost))
        for name, force in forces.items():
            k, body = index[name], free[name]
            if body.children or any(body.com):
                continue
            outer = sim.forces.get(name, (np.zeros(3), None))[0] + body.mass * np.array(sim.scene.gravity)
            gap = float(np.linalg.norm(force + outer - body.mass * (v1[k] - v0[k]) / h))
            worst["balance"] = max(worst["balance"], gap)
        for name, value in sim.own_residuals().items():
            worst[name] = max(worst.get(name, 0.0), value)
    return {name: float(value) for name, value in worst.items()}


def finite(value: float | np.floating) -> float | None:
    """A number for JSON: None for what is none."""
    return float(value) if np.isfinite(value) else None
