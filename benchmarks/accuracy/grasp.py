"""Own: the Panda's hand grasps a thing, lifts it, holds it for a minute, shakes it and turns the wrist."""

from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.accuracy import panda
from benchmarks.accuracy.case import BULLET, Case, Figure, Measurement, Settings, once, steps
from benchmarks.accuracy.engines import Simulation, build
from benchmarks.accuracy.measures import finite, residuals
from benchmarks.accuracy.scene import Array, Body, Geom, Scene, ground, rotation

FRICTION = 1.0
RESPONSE = 0.02  # [s] in which a motor takes away its error: PyBullet's gain of 0.1 at 2 ms
NEUTRAL = np.array([0, 0.41, 0, -1.85, 0, 2.26, 0.79, panda.OPEN, panda.OPEN])
START, LIFT = 0.15, 0.25  # [m]
HOLD, SHAKE = 60.0, 10.0  # [s]
THINGS = {
    "cube": Body("thing", (Geom("box", (0.02, 0.02, 0.02), FRICTION),), 1.0, (0, 0, 0.02)),
    "cylinder": Body("thing", (Geom("cylinder", (0.02, 0.03), FRICTION),), 0.5, (0, 0, 0.03)),
    "sphere": Body("thing", (Geom("sphere", (0.025,), FRICTION),), 0.2, (0, 0, 0.025)),
}


class Hand:
    """Leads the hand along a path, and says where the thing is in it."""

    def __init__(self, sim: Simulation, q: Array) -> None:
        self.sim, self.q, self.fingers = sim, q.copy(), panda.OPEN

    def drive(self) -> None:
        """Targets of all motors."""
        gain = min(1.0, self.sim.time_step / RESPONSE)
        for name, target, most in zip(panda.ARM, self.q, panda.FORCES, strict=False):
            self.sim.drive(name, float(target), gain, 1.0, most)
        for name in panda.FINGERS:
            self.sim.drive(name, self.fingers, gain, 1.0, panda.GRIP)

    def wait(self, seconds: float) -> None:
        """With the targets there are."""
        self.drive()
        self.sim.run(seconds, seconds)

    def follow(self, point: Callable[[float], Array], seconds: float) -> None:
        """The grasp along point(t), with a new target every step: jumps would throw anything out of any hand."""
        for k in range(round(seconds / self.sim.time_step)):
            self.q = panda.reach(point((k + 1) * self.sim.time_step), self.q)
            self.drive()
            self.sim.step()

    def move(self, start: Array, end: Array, seconds: float) -> None:
        """In a straight line, at rest at both ends."""
        self.follow(lambda t: start + (end - start) * smooth(t / seconds), seconds)

    def turn(self, angle: float, seconds: float) -> None:
        """The wrist, at rest at both ends."""
        before = self.q[6]
        for k in range(round(seconds / self.sim.time_step)):
            self.q[6] = before + angle * smooth((k + 1) * self.sim.time_step / seconds)
            self.drive()
            self.sim.step()

    def thing(self) -> Array:
        """The thing's centre in the hand's axes (3) [m]."""
        p, quat, _, _ = self.sim.states(["thing", panda.HAND])
        return rotation(quat[1]).T @ (p[0] - p[1])

    def off_centre(self) -> float:
        """By how much one finger is further in than the other [m]."""
        p, quat, _, _ = self.sim.states([panda.HAND, *panda.FINGERS])
        across = rotation(quat[0])[:, 1]
        return float(abs((p[1] - p[0]) @ across + (p[2] - p[0]) @ across))


def smooth(t: float) -> float:
    """From 0 to 1, with no acceleration at the ends."""
    t = min(max(t, 0.0), 1.0)
    return t * t * t * (10 - 15 * t + 6 * t * t)


def shaking(t: float) -> Array:
    """Much as users shake a hand to try a grasp; fades in and out within a second."""
    size = smooth(t) * smooth(SHAKE - t)
    wave = np.array([0.1 * np.sin(3 * np.pi * t), 0.1 * np.sin(2.4 * np.pi * t), 0.05 * np.sin(2 * np.pi * t)])
    return np.array([0, 0, LIFT]) + size * wave


def run(thing: str, settings: Settings) -> Measurement:
    """Drift of the thing in the hand in each part."""
    body = THINGS[thing]
    q = panda.reach(np.array([0, 0, START]), NEUTRAL, 30)
    q[7:] = panda.OPEN
    scene = Scene(
        (ground(FRICTION), panda.robot(FRICTION, q), body), servos=panda.servos(), mimics=(panda.MIMIC,), extent=0.05
    )
    sim = build(scene, settings)
    hand = Hand(sim, q)
    above, at, up = (np.array([0, 0, z]) for z in (START, body.pos[2], LIFT))
    hand.move(above, at, 1.0)
    hand.wait(0.3)
    hand.fingers = 0.0
    hand.wait(0.5)
    hand.move(at, up, 1.5)
    hand.wait(1.0)
    grasped = hand.thing()
    hand.wait(HOLD)
    held, centre = hand.thing(), hand.off_centre()
    hand.follow(shaking, SHAKE)
    hand.wait(0.5)
    shaken = hand.thing()
    hand.turn(-np.pi, 3.0)
    hand.wait(0.5)
    turned = hand.thing()
    rtf = sim.rtf
    kept = float(np.linalg.norm(turned - grasped)) < 0.02
    return Measurement(
        [
            Figure("drift at rest", finite(np.linalg.norm(held - grasped) / HOLD * 1e6), "µm/s", 1.0),
            Figure("drift by shaking", finite(np.linalg.norm(shaken - held) * 1e3), "mm", 0.5),
            Figure("drift by turning the wrist", finite(np.linalg.norm(turned - shaken) * 1e3), "mm", 0.5),
            Figure("fingers off centre", finite(centre * 1e3), "mm", 0.1),
        ],
        rtf,
        residuals(sim, 2),
        "" if kept else "dropped",
    )


def plan(engine: str) -> list[Settings]:
    """PyBullet with friction anchors, too."""
    return steps(engine) + (steps(engine, variants=["friction anchors"]) if engine == BULLET else [])


CASES = [
    Case(f"grasp {name}", f"the Panda holds a {name} of {body.mass:g} kg", partial(run, name), plan, once)
    for name, body in THINGS.items()
]
