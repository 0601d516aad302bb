"""Published: 25 balls on a box that is pushed over the ground."""

import numpy as np

from benchmarks.accuracy.case import (
    OURS,
    TIME_STEPS,
    Best,
    Case,
    Figure,
    Measurement,
    Settings,
    cross,
    measured,
    once,
    steps,
)
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import finite, residuals
from benchmarks.accuracy.scene import Body, G, Geom, Pair, Scene, ground

BOX, BALL, BALLS, FORCE = 10.0, 1.0, 25, 150.0  # [kg, kg, , N]
DIRECTION = np.array([0.5, np.sqrt(0.75), 0.0])
GROUND_FRICTION, BALL_FRICTION = 0.4, 0.8
NAMES = [f"ball{k}" for k in range(BALLS)]


def scene() -> Scene:
    """Where frictions multiply, 0.5 x 0.8 and 0.8 x 1 make those of the pairs."""
    box = Body("box", (Geom("box", (10, 10, 0.5), GROUND_FRICTION, product_friction=0.8),), BOX, (0, 0, 0.5))
    balls = [
        Body(name, (Geom("sphere", (0.5,), BALL_FRICTION, product_friction=1.0),), BALL, (4 - 2 * x, 4 - 2 * y, 1.5))
        for name, (x, y) in zip(NAMES, np.ndindex(5, 5), strict=True)
    ]
    pairs = [Pair("ground", "box", GROUND_FRICTION), *(Pair("box", name, BALL_FRICTION) for name in NAMES)]
    return Scene((ground(GROUND_FRICTION, product_friction=0.5), box, *balls), pairs=tuple(pairs), extent=10)


def accelerations() -> tuple[float, float]:
    """Of the box and of a ball: the box slides, a ball rolls on it (moment of inertia 2/5 m r^2)."""
    box = (FORCE - GROUND_FRICTION * (BOX + BALLS * BALL) * G) / (BOX + BALLS * BALL * 2 / 7)
    return box, 2 / 7 * box


def run(settings: Settings) -> Measurement:
    """Squared error of the box's velocity and a ball's (mean of all), averaged over 4 s."""
    sim = build(scene(), settings)
    sim.set_force("box", FORCE * DIRECTION)
    of_box, of_ball = accelerations()
    errors: list[float] = []

    def look() -> None:
        v = sim.states(["box", *NAMES])[3]
        box = v[0] - of_box * sim.time * DIRECTION
        balls = v[1:] - of_ball * sim.time * DIRECTION
        errors.append(float(box @ box + (balls * balls).sum(1).mean()))

    sim.run(4.0, look=look)
    rtf = sim.rtf
    figure = Figure("squared velocity error", finite(np.mean(errors)), "m²/s²", 1e-12, 23)
    result = measured(sim, [figure], residuals(sim))
    result.rtf = rtf
    return result


def plan(engine: str) -> list[Settings]:
    """Ours at the tightest tolerance, too: the best that was published was run so."""
    return cross(engine) + (steps(engine, TIME_STEPS, ["tolerance 1e-15"]) if engine == OURS else [])


CASES = [
    Case(
        "rolling",
        "25 balls on a pushed box, 4 s",
        run,
        plan,
        once,
        (
            Best("RaiSim", 10**-6.4, 10),
            Best("RaiSim", 10**-5.2, 23),
            Best("Bullet 2018", 1e-26, 2.2),
            Best("Bullet 2018", 10**-5.8, 9),
            Best("MuJoCo 1.50", 10**-2.2, None),
        ),
        judge="curve",
        curve=True,
    )
]
