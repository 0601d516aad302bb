"""Own: PyBullet's position motor, in every type of joint, beside PyBullet itself swept until it stays."""

from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.accuracy.case import BULLET, Case, Figure, Measurement, Settings, steps
from benchmarks.accuracy.engines import Simulation, build
from benchmarks.accuracy.measures import finite
from benchmarks.accuracy.scene import Array, Body, Scene, rotation

SECONDS, CHANGES = 1.0, 4  # targets change so many times
STRONG, WEAK = 1e5, 6.0  # [N m, N]: never reached, often reached
KP, KD = 0.1, 1.0
WRIST = 1e4  # [N m] never reached: PyBullet bounds a ball joint's torque along the world's axes, not the joint's own
LINKS = ("turn", "shift", "bend")
SWEEPS = 2000  # after which PyBullet's answer stays


def scene() -> Scene:
    """A hinge, a slide, a hinge and a ball joint, one after the other."""
    wrist = Body("wrist", (), 0.5, (0.25, 0, 0), joint="ball", com=(0.05, 0.02, 0), inertia=(0.002, 0.003, 0.004))
    bend = Body(
        "bend", (), 0.7, (0.1, 0, -0.1), joint="hinge", axis=(0, 1, 0), q=0.3, com=(0.1, 0, 0.02),
        inertia=(0.003, 0.01, 0.009), children=(wrist,),
    )  # fmt: skip
    shift = Body(
        "shift", (), 1.0, (0.2, 0, 0.1), joint="slide", axis=(1, 0, 0), q=0.05, com=(0.02, 0.01, 0),
        inertia=(0.01, 0.012, 0.011), children=(bend,),
    )  # fmt: skip
    turn = Body(
        "turn", (), 2.0, (0, 0, 0.5), joint="hinge", axis=(0, 0.6, 0.8), com=(0.1, 0, 0.05),
        inertia=(0.02, 0.03, 0.03), children=(shift,),
    )  # fmt: skip
    return Scene((turn,), contacts=False)


def path(settings: Settings, strength: float) -> tuple[Array, Array, Simulation]:
    """Positions (steps, 4, 3) and rotations (steps, 4, 3, 3) of the links."""
    sim = build(scene(), settings)
    rng = np.random.default_rng(3)
    q = rng.uniform(-0.5, 0.5, (CHANGES, len(LINKS))) * (1, 0.2, 1)
    count = round(SECONDS / settings.time_step)
    places, turns = [], []
    for k in range(count):
        part = k * CHANGES // count
        for name, target in zip(LINKS, q[part], strict=True):
            sim.drive(name, target, KP, KD, strength)
        sim.spin("wrist", np.zeros(3), KD, WRIST)  # PyBullet drops other velocities
        sim.step()
        p, quat, _, _ = sim.states([*LINKS, "wrist"])
        places.append(p)
        turns.append(rotation(quat))
    return np.array(places), np.array(turns), sim


def apart(one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
    """The greatest distance [m] or angle [rad] between two paths."""
    relative = np.einsum("knji,knjl->knil", one[1], other[1])
    skew = 0.5 * np.stack([relative[..., 2, 1] - relative[..., 1, 2], relative[..., 0, 2] - relative[..., 2, 0],
                           relative[..., 1, 0] - relative[..., 0, 1]])  # fmt: skip
    angle = np.arctan2(np.linalg.norm(skew, axis=0), (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2)
    return float(max(np.abs(one[0] - other[0]).max(), np.abs(angle).max()))


def run(settings: Settings) -> Measurement:
    """Both strengths."""
    truth = replace(settings, engine=BULLET, variant="defaults", iterations=SWEEPS)
    figures, sim = [], None
    for name, strength in (("never saturated", STRONG), ("saturated", WEAK)):
        *own, sim = path(settings, strength)
        *other, _ = path(truth, strength)
        figures.append(Figure(f"path, {name}", finite(apart((own[0], own[1]), (other[0], other[1]))), "rad, m", 1e-6))
    assert sim is not None
    return Measurement(figures, sim.rtf)


CASES = [Case("motor", "PyBullet's position motor in four joints, 1 s", run, steps, partial(steps, time_steps=[0.002]))]
