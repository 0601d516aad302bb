"""Published: spheres without friction that bounce, fall in a pile, or both."""

import numpy as np

from benchmarks.accuracy.case import (
    BULLET,
    MUJOCO,
    VARIANTS,
    Best,
    Case,
    Figure,
    Measurement,
    Settings,
    cross,
    measured,
    once,
)
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import Mass, finite, residuals
from benchmarks.accuracy.scene import Array, Body, Geom, Scene, ground

MASS, RADIUS = 10.0, 0.1
# MuJoCo has no restitution; a contact that is a spring without a damper gives back what it took. The stiffest that the
# step bears (period of two balls' contact: 20 steps).
ELASTIC = {BULLET: {"contactERP": 0.0, "erp": 0.0}}
ENERGY = "squared energy error"


def ball(name: str, position: Array) -> Body:
    """Without friction."""
    return Body(name, (Geom("sphere", (RADIUS,), 0.0),), MASS, tuple(float(x) for x in position))  # type: ignore[arg-type]


def grid(lowest: float) -> Scene:
    """6 x 6 x 6 spheres, each disturbed by up to a millimetre along each axis."""
    rng = np.random.default_rng(42)
    places = [0.21 * np.array([i, j, k]) + rng.uniform(0, 0.001, 3) + (0, 0, lowest) for i, j, k in np.ndindex(6, 6, 6)]
    return Scene((ground(0.0), *(ball(f"ball{k}", p) for k, p in enumerate(places))))


def elastic(scene: Scene) -> Scene:
    """With restitution 1."""
    return Scene(scene.bodies, restitution=1.0)


def bouncing_scene() -> Scene:
    """7 x 7 balls side by side, 5 m up."""
    places = [np.array([i, j, 5.0]) for i, j in np.ndindex(7, 7)]
    return elastic(Scene((ground(0.0), *(ball(f"ball{k}", p) for k, p in enumerate(places)))))


def with_springs(settings: Settings) -> Settings:
    """MuJoCo's elastic contact at this step."""
    if settings.engine == MUJOCO:
        stiffness = (2 * np.pi / (20 * settings.time_step)) ** 2
        settings.options["solref"] = f"{-stiffness!r} 0"
        settings.options["solimp"] = "0.99 0.99 0.001"
    return settings


def energy_run(
    scene: Scene, seconds: float, figure: tuple[float | None, float | None], settings: Settings
) -> Measurement:
    """Squared error of the total energy, averaged over the run."""
    sim = build(scene, with_springs(settings))
    mass = Mass(scene)
    start = mass.energy(sim)
    errors: list[float] = []
    sim.run(seconds, look=lambda: errors.append((mass.energy(sim) - start) ** 2))
    return measured(sim, [Figure(ENERGY, finite(np.mean(errors)), "J²", *figure)])


def bouncing(settings: Settings) -> Measurement:
    """Nothing is published in numbers: the least error of this run counts."""
    return energy_run(bouncing_scene(), 20.0, (None, None), settings)


def elastic_pile(settings: Settings) -> Measurement:
    """10 s from 1.101 m."""
    return energy_run(elastic(grid(1.101)), 10.0, (1e-3, 2.0), settings)


def overlap(p: Array) -> float:
    """Sum over all pairs, the ground included, of the depth squared [m^2]."""
    total = float((np.minimum(p[:, 2] - RADIUS, 0) ** 2).sum())
    apart = p[:, None] - p[None]
    distance = np.sqrt((apart * apart).sum(-1))[np.triu_indices(len(p), 1)]
    return total + float((np.maximum(2 * RADIUS - distance, 0) ** 2).sum())


def pile(settings: Settings) -> Measurement:
    """Squared depth, summed over pairs, averaged over 10 s."""
    scene = grid(0.101)
    sim = build(scene, settings)
    names = [body.name for body in scene.moving()]
    depths: list[float] = []
    sim.run(10.0, look=lambda: depths.append(overlap(sim.states(names)[0])))
    rtf = sim.rtf
    result = measured(
        sim, [Figure("squared depth, all pairs", finite(np.mean(depths)), "m²", 1e-6, 1.0)], residuals(sim, 2)
    )
    result.rtf = rtf
    return result


def plan(engine: str) -> list[Settings]:
    """Without erp, which would feed energy in. The springs of MuJoCo's elastic contacts leave its variants nothing."""
    return cross(engine, ELASTIC, VARIANTS[engine][:1])


CASES = [
    Case("bouncing", "49 elastic balls from 5 m, 20 s", bouncing, plan, once, judge="curve", curve=True),
    Case(
        "666",
        "216 inelastic spheres fall in a pile, 10 s",
        pile,
        cross,
        lambda engine: once(engine, 0.008),
        (
            Best("RaiSim", 10**-5.8, 0.8),
            Best("ODE", 1e-4, 1),
            Best("MuJoCo 1.50", 0.1, 0.8),
            Best("Bullet 2018", 10**-0.4, 0.8),
        ),
        judge="curve",
        curve=True,
    ),
    Case(
        "elastic 666",
        "216 elastic spheres from 1 m, 10 s",
        elastic_pile,
        plan,
        lambda engine: once(engine, 0.008),
        (Best("RaiSim", 1e-3, 1.6), Best("ODE", 1.0, 0.18), Best("Bullet 2018", 10**2.2, 0.47)),
        judge="curve",
        curve=True,
    ),
]
