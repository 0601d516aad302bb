"""Own: two spheres meet, for all restitutions and mass ratios."""

import numpy as np

from benchmarks.accuracy.case import BULLET, Case, Figure, Measurement, Settings, once, steps
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import Mass, finite
from benchmarks.accuracy.scene import Body, Geom, Scene

RESTITUTIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
RATIOS = (1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3, 1e4)
RADIUS, SPEED = 0.1, 1.0  # [m, m/s]
DIRECTION = np.array([0.48, 0.6, 0.64])


def scene(restitution: float, ratio: float) -> Scene:
    """The second sphere rests, 2.03 cm away."""
    apart = (2 * RADIUS + 0.0203) * DIRECTION
    geom = Geom("sphere", (RADIUS,), 0.0)
    first = Body("first", (geom,), 1.0, velocity=tuple(float(x) for x in SPEED * DIRECTION))  # type: ignore[arg-type]
    second = Body("second", (geom,), ratio, tuple(float(x) for x in apart))  # type: ignore[arg-type]
    return Scene((first, second), gravity=(0, 0, 0), restitution=restitution)


def run(settings: Settings) -> Measurement:
    """The worst of all pairs."""
    of_momentum, of_restitution = 0.0, 0.0
    spent = simulated = 0.0
    for e in RESTITUTIONS:
        for ratio in RATIOS:
            sim = build(scene(e, ratio), settings)
            mass = Mass(sim.scene)
            first = mass.momentum(sim)
            sim.run(0.2, 0.2)
            v = sim.states(["first", "second"])[3]
            apart = float((v[1] - v[0]) @ DIRECTION)
            of_momentum = max(of_momentum, float(np.linalg.norm(mass.momentum(sim) - first) / np.linalg.norm(first)))
            of_restitution = max(of_restitution, abs(apart - e * SPEED) / SPEED)
            spent, simulated = spent + sim.spent, simulated + sim.time
    return Measurement(
        [
            Figure("momentum, relative error", finite(of_momentum), "", 1e-12),
            Figure("restitution, of the speed", finite(of_restitution), "", 1e-6),
        ],
        simulated / max(spent, 1e-9),
    )


def plan(engine: str) -> list[Settings]:
    """Without erp, which would push them apart."""
    return steps(engine, options={BULLET: {"contactERP": 0.0, "erp": 0.0}})


CASES = [Case("impulse", "two spheres, all restitutions and mass ratios", run, plan, once)]
