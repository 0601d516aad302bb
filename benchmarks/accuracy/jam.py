"""Own: a rod that slides on its tip, and a peg that jams: no energy from nowhere, nothing infinite, little depth."""

from collections.abc import Callable

import numpy as np

from benchmarks.accuracy.case import Case, Figure, Measurement, Settings, once, steps
from benchmarks.accuracy.engines import Simulation, build
from benchmarks.accuracy.measures import Mass, corners, finite, placed, residuals
from benchmarks.accuracy.scene import Array, Body, G, Geom, Scene, about, ground, rotation

ROD_FRICTION, ROD_RADIUS, ROD_HALF = 2.0, 0.02, 0.5
ROD_LEAN = np.radians(35.0)  # from upright; Painleve's paradox needs friction over 4/3
ROD_SPEED = 3.0  # [m/s]
PEG, PEG_FRICTION, PEG_LEAN = (0.03, 0.01, 0.012), 0.8, 0.1  # half sizes [m], , [rad]
PUSH, TURN = 30.0, 1.0  # [N, N m]: down, and towards more lean, which wedges it
PEG_DEPTH = 0.1  # [mm]
GAIN_BOUND = 1e-6  # of the energy there was at first


def rod_scene() -> Scene:
    """Its tip on the ground, thrown so that the tip slides into the ground."""
    height = ROD_RADIUS + ROD_HALF * np.cos(ROD_LEAN)
    geom = Geom("capsule", (ROD_RADIUS, ROD_HALF), ROD_FRICTION)
    lean = about((0, 1, 0), ROD_LEAN)
    rod = Body("rod", (geom,), 1.0, (0, 0, float(height)), lean, velocity=(-ROD_SPEED, 0, 0))
    return Scene((ground(ROD_FRICTION), rod))


def rod_depth(p: Array, quat: Array) -> float:
    """Of the deeper end below the ground."""
    ends = placed(p, quat, np.array([(0, 0, -ROD_HALF), (0, 0, ROD_HALF)]))
    return ROD_RADIUS - float(ends[:, 2].min())


HALF = float(PEG[0] * np.cos(PEG_LEAN) + PEG[2] * np.sin(PEG_LEAN))  # of the slot


def peg_scene() -> Scene:
    """Leaning, between two fixed walls, touching both: a corner each, so low apart that friction holds any push."""
    walls = [
        Body(name, (Geom("box", (0.05, 0.05, 0.2), PEG_FRICTION),), pos=(side * (HALF + 0.05), 0, 0.5), joint="fixed")
        for name, side in (("left", -1), ("right", 1))
    ]
    peg = Body("peg", (Geom("box", PEG, PEG_FRICTION),), 0.1, (0, 0, 0.5), about((0, 1, 0), PEG_LEAN))
    return Scene((*walls, peg), extent=0.05)


def peg_depth(p: Array, quat: Array) -> float:
    """Of the deepest corner in a wall."""
    points = placed(p, quat, corners(PEG))
    inside = np.abs(points[:, 2] - 0.5) < 0.2
    return float((np.abs(points[inside, 0]) - HALF).max(initial=-1.0))


def watch(
    sim: Simulation,
    name: str,
    seconds: float,
    depth: Callable[[Array, Array], float],
    depth_bound: float,
    given: Callable[[Array, Array], float],
) -> Measurement:
    """The most energy gained over what there was and what was given, and the greatest depth [mm]."""
    mass = Mass(sim.scene)
    energy, weight = mass.energy(sim), mass.mass[0] * G
    first = max(energy - weight * float(sim.position(name)[2]), weight * 0.1)
    gains, depths = [0.0], [0.0]

    def look() -> None:
        p, quat, _, _ = sim.states([name])
        gains.append(mass.energy(sim) - energy - given(p[0], quat[0]))
        depths.append(depth(p[0], quat[0]) * 1e3)

    sim.run(seconds, sim.time_step, look)
    return Measurement(
        [
            Figure("energy from nowhere, of the first", finite(np.max(gains) / first), "", GAIN_BOUND),
            Figure("penetration", finite(np.max(depths)), "mm", depth_bound),
        ],
        sim.rtf,
    )


def rod(settings: Settings) -> Measurement:
    """3 s; its depth is bounded by what it travels in a step."""
    sim = build(rod_scene(), settings)
    return watch(sim, "rod", 3.0, rod_depth, ROD_SPEED * sim.time_step * 1e3, lambda p, quat: 0.0)


class Work:
    """What the push and the turn have given to the peg."""

    def __init__(self) -> None:
        self.lean = PEG_LEAN
        self.turned = 0.0

    def __call__(self, p: Array, quat: Array) -> float:
        lean = lean_of(quat)
        self.turned += (lean - self.lean + np.pi) % (2 * np.pi) - np.pi
        self.lean = lean
        return PUSH * (0.5 - float(p[2])) + TURN * self.turned


def lean_of(quat: Array) -> float:
    """About y [rad]."""
    R = rotation(quat)
    return float(np.arctan2(R[0, 2], R[2, 2]))


def peg(settings: Settings) -> Measurement:
    """5 s under the push."""
    sim = build(peg_scene(), settings)
    sim.set_force("peg", (0, 0, -PUSH), (0, TURN, 0))
    result = watch(sim, "peg", 5.0, peg_depth, PEG_DEPTH, Work())
    p, quat, _, _ = sim.states(["peg"])
    result.note = f"ends {(0.5 - p[0][2]) * 1e3:.2g} mm lower, leaning {np.degrees(lean_of(quat[0])):.3g}°"
    result.residuals = residuals(sim)
    return result


CASES = [
    Case("painleve", "a rod sliding on its tip, friction 2", rod, steps, once),
    Case("jam", "a peg wedged between two walls", peg, steps, once),
]
