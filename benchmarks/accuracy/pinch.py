"""Own: a capsule between two pads on springs: how fast does it creep down? After MuJoCo's issue 3328."""

import numpy as np

from benchmarks.accuracy.case import MUJOCO, Case, Figure, Measurement, Settings, cross, once, steps
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import finite, residuals
from benchmarks.accuracy.scene import Body, Geom, Motor, Scene, about

FRICTION = 0.7
SETTLE, HOLD = 2.0, 60.0  # [s]


def pad(name: str, side: float) -> Body:
    """100 g on a slide with a damper."""
    geom = Geom("box", (0.004, 0.02, 0.02), FRICTION)
    return Body(name, (geom,), 0.1, (0.010 * side, 0, 0.2), joint="slide", axis=(-side, 0, 0), damping=20.0)


def scene() -> Scene:
    """Each spring pushes 4 mm towards the middle, where there is room for 2: 12 N."""
    capsule = Geom("capsule", (0.004, 0.015), FRICTION, quat=about((1, 0, 0), -np.pi / 2))
    held = Body("held", (capsule,), 0.045, (0, 0, 0.2))
    motors = (Motor("left", 6000.0, 0.004), Motor("right", 6000.0, 0.004))
    return Scene((pad("left", -1), pad("right", 1), held), motors=motors, extent=0.02)


def run(settings: Settings) -> Measurement:
    """Speed downwards over 60 s, after 2 s to settle; and whether both pads feel the same force."""
    sim = build(scene(), settings)
    sim.run(SETTLE, SETTLE)
    start = sim.position("held")
    sim.run(HOLD, 1.0)
    rtf = sim.rtf
    moved = sim.position("held") - start
    creep = Figure("creep", finite(abs(moved[2]) / HOLD * 1e6), "µm/s", 1.0)
    aside = Figure("creep sideways", finite(np.hypot(moved[0], moved[1]) / HOLD * 1e6), "µm/s", 1.0)
    return Measurement([creep, aside], rtf, residuals(sim))


def plan(engine: str) -> list[Settings]:
    """MuJoCo's defaults, of which users speak, too."""
    own = steps(engine, variants=["defaults", "elliptic, noslip 10"]) if engine == MUJOCO else []
    return cross(engine) + own


CASES = [Case("pinch", "a capsule held by two pads, 60 s", run, plan, once, curve=True)]
