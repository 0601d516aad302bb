"""Own: pendulums, a double pendulum, a four-bar: as trees and with closed loops."""

from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.accuracy.case import LANES, MUJOCO, OURS, Case, Figure, Measurement, Settings, measured, steps
from benchmarks.accuracy.engines import Simulation, build
from benchmarks.accuracy.measures import finite
from benchmarks.accuracy.scene import Array, Body, G, Loop, Scene, about, rotation

LENGTH, MASS, AMPLITUDE = 1.0, 1.0, 0.5  # [m, kg, rad]
PERIODS = 10
COUPLER, COUPLER_MASS = 0.6, 2.0  # [m, kg]
DOUBLE_SECONDS = 2.0
DOUBLE_START = (0.6, -0.4)  # [rad], absolute angles
ACCURATE_STEPS = (0.0005, 0.001, 0.002, 0.004)


def elliptic_period(frequency: float, amplitude: float) -> float:
    """Of a pendulum whose small oscillations have that angular frequency: 4 K(sin(a/2)) / w, by the arithmetic mean."""
    a, b = 1.0, float(np.cos(amplitude / 2))
    while abs(a - b) > 1e-16:
        a, b = (a + b) / 2, float(np.sqrt(a * b))
    return 2 * np.pi / (frequency * (a + b) / 2)


def rod_at(name: str, pos: tuple[float, float, float], q: float, **more: object) -> Body:
    """A thin rod that hangs from its hinge about y, turned by q."""
    moment = MASS * LENGTH**2 / 12
    rod = Body(
        name, (), MASS, pos, joint="hinge", axis=(0, 1, 0), q=q, com=(0, 0, -LENGTH / 2), inertia=(moment, moment, 1e-4)
    )
    return replace(rod, **more)  # type: ignore[arg-type]


def free_rod(name: str, hinge: Array, angle: float) -> Body:
    """The same rod, held by nothing: its origin is its centre."""
    quat = about((0, 1, 0), angle)
    center = hinge + rotation(quat) @ np.array([0, 0, -LENGTH / 2])
    moment = MASS * LENGTH**2 / 12
    return Body(name, (), MASS, tuple(float(x) for x in center), quat, inertia=(moment, moment, 1e-4))  # type: ignore[arg-type]


def hinge_by_points(first: str, second: str, other: tuple[float, float, float]) -> tuple[Loop, Loop]:
    """A hinge about y at the upper end of `first`: two points held, 10 cm to the left and the right."""
    x, _, z = other
    return (
        Loop(first, second, (0, -0.1, LENGTH / 2), (x, -0.1, z)),
        Loop(first, second, (0, 0.1, LENGTH / 2), (x, 0.1, z)),
    )


def angle_of(sim: Simulation, name: str) -> float:
    """About y [rad]."""
    R = sim.turn(name)
    return float(np.arctan2(R[0, 2], R[2, 2]))


def period(sim: Simulation, name: str, want: float, look: object = None) -> float:
    """From the first upward crossing of zero to the last, by cubics through four steps."""
    count = int((PERIODS + 0.8) * want / sim.time_step)
    angles = np.empty(count)
    for k in range(count):
        sim.step()
        angles[k] = angle_of(sim, name)
        if callable(look):
            look()
    rising = np.flatnonzero((angles[1:-2] < 0) & (angles[2:-1] >= 0)) + 1
    if len(rising) < 2:
        return float("nan")
    crossings = [crossing(angles[k - 1 : k + 3]) + k for k in (rising[0], rising[-1])]
    return (crossings[1] - crossings[0]) * sim.time_step / (len(rising) - 1)


def crossing(y: Array) -> float:
    """Where the cubic through (-1, y0), (0, y1), (1, y2), (2, y3) is zero between 0 and 1."""
    c = np.polyfit([-1, 0, 1, 2], y, 3)
    x = y[1] / (y[1] - y[2])
    for _ in range(6):
        x -= np.polyval(c, x) / np.polyval(np.polyder(c), x)
    return float(x)


def gaps(sim: Simulation) -> float:
    """The widest loop [m]."""
    worst = 0.0
    for loop in sim.scene.loops:
        ends = [np.array(loop.other) if loop.second == "world" else np.empty(0), np.empty(0)]
        for k, (name, point) in enumerate(((loop.second, loop.other), (loop.first, loop.point))):
            if name != "world":
                p, quat, _, _ = sim.states([name])
                ends[k] = p[0] + rotation(quat[0]) @ np.array(point)
        worst = max(worst, float(np.linalg.norm(ends[0] - ends[1])))
    return worst


def swing(scene: Scene, name: str, want: float, settings: Settings) -> Measurement:
    """The period, and how far the loops open."""
    sim = build(scene, settings)
    widest = [0.0]
    look = (lambda: widest.append(gaps(sim))) if scene.loops else None
    found = period(sim, name, want, look)
    figures = [Figure("period, relative error", finite(abs(found - want) / want), "", 1e-6)]
    if scene.loops:
        figures.append(Figure("loop error", finite(max(widest)), "m", 1e-6))
    return measured(sim, figures)


def rod_frequency() -> float:
    """Of small oscillations of the hinged rod."""
    return float(np.sqrt(1.5 * G / LENGTH))


def pendulum(loop: bool, settings: Settings) -> Measurement:
    """A rod on a hinge, or held at two points of its axis."""
    if loop:
        rod = free_rod("rod", np.array([0, 0, 2.0]), AMPLITUDE)
        scene = Scene((rod,), loops=hinge_by_points("rod", "world", (0, 0, 2.0)), contacts=False)
    else:
        scene = Scene((rod_at("rod", (0, 0, 2.0), AMPLITUDE),), contacts=False)
    return swing(scene, "rod", elliptic_period(rod_frequency(), AMPLITUDE), settings)


def four_bar(settings: Settings) -> Measurement:
    """Two equal rods and a coupler that stays level: a pendulum with the coupler's mass at its end."""
    moment = COUPLER_MASS * COUPLER**2 / 12
    coupler = Body(
        "coupler", (), COUPLER_MASS, (0, 0, -LENGTH), joint="hinge", axis=(0, 1, 0), q=-AMPLITUDE,
        com=(COUPLER / 2, 0, 0), inertia=(1e-4, moment, moment),
    )  # fmt: skip
    left = rod_at("left", (0, 0, 2), AMPLITUDE, children=(coupler,))
    right = rod_at("right", (COUPLER, 0, 2), AMPLITUDE)
    loop = Loop("coupler", "right", (COUPLER, 0, 0), (0, 0, -LENGTH))
    scene = Scene((left, right), loops=(loop,), contacts=False)
    inertia = 2 * MASS * LENGTH**2 / 3 + COUPLER_MASS * LENGTH**2
    weight = 2 * MASS * G * LENGTH / 2 + COUPLER_MASS * G * LENGTH
    return swing(scene, "left", elliptic_period(float(np.sqrt(weight / inertia)), AMPLITUDE), settings)


def double_pendulum_truth(seconds: float) -> Array:
    """Absolute angles (2) of two rods, by Lagrange's equations and RK4 at 0.1 ms."""
    m, length = MASS, LENGTH

    def rate(y: Array) -> Array:
        a, b, u, v = y
        c, s = np.cos(a - b), np.sin(a - b)
        M = m * length**2 * np.array([[4 / 3, c / 2], [c / 2, 1 / 3]])
        f = m * length**2 / 2 * np.array([-s * v * v, s * u * u]) - m * G * length * np.array(
            [1.5 * np.sin(a), 0.5 * np.sin(b)]
        )
        return np.array([u, v, *np.linalg.solve(M, f)])

    y, h = np.array([*DOUBLE_START, 0.0, 0.0]), 1e-4
    for _ in range(round(seconds / h)):
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        k4 = rate(y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return y[:2]


def double_pendulum(loop: bool, settings: Settings) -> Measurement:
    """Angles after 2 s beside Lagrange's equations."""
    a, b = DOUBLE_START
    if loop:
        low = np.array([0, 0, 2.0]) + rotation(about((0, 1, 0), a)) @ np.array([0, 0, -LENGTH])
        upper, lower = free_rod("upper", np.array([0, 0, 2.0]), a), free_rod("lower", low, b)
        loops = (
            *hinge_by_points("upper", "world", (0, 0, 2.0)),
            *hinge_by_points("lower", "upper", (0, 0, -LENGTH / 2)),
        )
        scene = Scene((upper, lower), loops=loops, contacts=False)
    else:
        lower = rod_at("lower", (0, 0, -LENGTH), b - a)
        scene = Scene((rod_at("upper", (0, 0, 2.0), a, children=(lower,)),), contacts=False)
    sim = build(scene, settings)
    widest = [0.0]
    sim.run(DOUBLE_SECONDS, look=lambda: widest.append(gaps(sim)))
    error = np.abs(np.array([angle_of(sim, "upper"), angle_of(sim, "lower")]) - double_pendulum_truth(sim.time)).max()
    figures = [Figure("angle after 2 s", finite(error), "rad", None if loop else 1e-6)]
    if loop:
        figures.append(Figure("loop error", finite(max(widest)), "m", 1e-6))
    return measured(sim, figures)


def tree_plan(engine: str) -> list[Settings]:
    """Both integrators where there are two."""
    plain = steps(engine, ACCURATE_STEPS, [""] if engine in (OURS, LANES, MUJOCO) else ["defaults"])
    rk4 = steps(engine, ACCURATE_STEPS, [""], integrator="rk4") if engine in (OURS, MUJOCO) else []
    return rk4 + plain


def tree_quick(engine: str) -> list[Settings]:
    """RK4, if it has it."""
    return tree_plan(engine)[2:3]


def loop_plan(engine: str) -> list[Settings]:
    """Small steps, as the period asks for."""
    return steps(engine, ACCURATE_STEPS)


def loop_quick(engine: str) -> list[Settings]:
    """At 1 ms."""
    return loop_plan(engine)[1:2]


CASES = [
    Case("pendulum", "a rod on a hinge, 10 periods", partial(pendulum, False), tree_plan, tree_quick, judge="curve"),
    Case(
        "pendulum in a loop",
        "the rod held at two points",
        partial(pendulum, True),
        loop_plan,
        loop_quick,
        judge="curve",
    ),
    Case(
        "double pendulum",
        "two rods on hinges, 2 s",
        partial(double_pendulum, False),
        tree_plan,
        tree_quick,
        judge="curve",
    ),
    Case(
        "double pendulum in loops",
        "the rods held at points",
        partial(double_pendulum, True),
        loop_plan,
        loop_quick,
        judge="curve",
    ),
    Case("four-bar", "a closed parallelogram, 10 periods", four_bar, loop_plan, loop_quick, judge="curve"),
]
