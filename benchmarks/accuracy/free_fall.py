"""Published: a floating tree of 18 degrees of freedom, thrown, then left alone."""

import numpy as np

from benchmarks.accuracy.case import (
    LANES,
    MUJOCO,
    OURS,
    TIME_STEPS,
    Best,
    Case,
    Figure,
    Measurement,
    Settings,
    measured,
    once,
    steps,
)
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import Mass, finite
from benchmarks.accuracy.scene import Body, Scene

THROW, FLIGHT = 1.0, 2.0  # [s]


def leg(name: str, front: int, left: int) -> Body:
    """Hip about x, thigh and shank about y; a four-legged robot's sizes."""
    bend = 0.4 * front
    shank = Body(
        f"{name}_shank", (), 0.8, (0.0, 0.05 * left, -0.28), joint="hinge", axis=(0, 1, 0), q=-2 * bend,
        com=(0.02, 0.0, -0.14), inertia=(0.0065, 0.0066, 0.0009),
    )  # fmt: skip
    thigh = Body(
        f"{name}_thigh", (), 2.0, (0.06 * front, 0.04 * left, 0.0), joint="hinge", axis=(0, 1, 0), q=bend,
        com=(0.0, 0.015 * left, -0.16), inertia=(0.021, 0.02, 0.005), children=(shank,),
    )  # fmt: skip
    return Body(
        f"{name}_hip", (), 1.6, (0.28 * front, 0.12 * left, 0.0), joint="hinge", axis=(1, 0, 0), q=0.03 * left,
        com=(0.03 * front, 0.0, 0.0), inertia=(0.003, 0.004, 0.004), children=(thigh,),
    )  # fmt: skip


def scene() -> Scene:
    """No contact, no damping."""
    legs = tuple(leg(f"leg{front}{left}", front, left) for front in (-1, 1) for left in (-1, 1))
    base = Body("base", (), 16.5, (0, 0, 2), inertia=(0.21, 0.58, 0.65), children=legs)
    return Scene((base,), contacts=False)


def run(settings: Settings) -> Measurement:
    """The base is pushed up at its centre with twice the weight for 1 s; energy is kept for the 2 s after."""
    tree = scene()
    sim = build(tree, settings)
    mass = Mass(tree)
    total = mass.mass.sum()
    push = -2 * total * mass.gravity
    sim.set_force("base", push)
    first = mass.momentum(sim)
    sim.run(THROW, THROW)
    thrown = sim.time
    sim.set_force("base", np.zeros(3))
    energy = mass.energy(sim)
    of_energy, of_momentum = [], []

    def look() -> None:
        of_energy.append((mass.energy(sim) - energy) ** 2)
        want = first + push * thrown + total * mass.gravity * sim.time
        error = mass.momentum(sim) - want
        of_momentum.append(float(error @ error))

    sim.run(FLIGHT, look=look)
    return measured(
        sim,
        [
            Figure("squared energy error", finite(np.mean(of_energy)), "J²", 1e-10, 220),
            Figure("squared momentum error", finite(np.mean(of_momentum)), "kg²m²/s²"),
        ],
    )


def plan(engine: str) -> list[Settings]:
    """Both integrators where there are two."""
    if engine in (LANES, "PyBullet"):
        return steps(engine, TIME_STEPS, [""] if engine == LANES else ["defaults"])
    both = [*steps(engine, TIME_STEPS, [""], integrator="rk4"), *steps(engine, TIME_STEPS, [""])]
    return both + (steps(engine, TIME_STEPS, [""], integrator="Euler") if engine == MUJOCO else [])


def quick(engine: str) -> list[Settings]:
    """RK4, if it has it."""
    return steps(engine, [0.004], [""], integrator="rk4") if engine in (OURS, MUJOCO) else once(engine)


CASES = [
    Case(
        "free fall",
        "a tree of 18 degrees of freedom, thrown",
        run,
        plan,
        quick,
        (
            Best("MuJoCo 1.50", 10**-20.5, 1),
            Best("MuJoCo 1.50", 1e-10, 220),
            Best("RaiSim", 1e-6, 2.2),
            Best("RaiSim", 10**0.2, 2200),
            Best("Bullet 2018", 10**-1.5, 0.4),
            Best("DART", 10**2.3, None),
        ),
        judge="curve",
        curve=True,
    )
]
