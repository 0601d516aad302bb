"""Own: a body of three inertias, free, spinning about its middle axis: it turns over, again and again."""

import numpy as np

from benchmarks.accuracy.case import LANES, MUJOCO, OURS, Case, Figure, Measurement, Settings, measured, steps
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.loops import crossing
from benchmarks.accuracy.measures import Mass, finite
from benchmarks.accuracy.scene import Body, Scene

MOMENTS = (0.01, 0.02, 0.03)  # [kg m^2]
OMEGA = (0.1, 6.0, 0.1)  # [rad/s], at first: body and world axes are one
PERIODS = 4


def flip_period() -> float:
    """Of the angular velocity in the body: 4 K(k) / w (Landau and Lifshitz, Mechanics, section 37)."""
    a, b, c = MOMENTS
    w = np.array(OMEGA)
    energy2 = float(np.array(MOMENTS) @ (w * w))
    momentum2 = float(((np.array(MOMENTS) * w) ** 2).sum())
    if momentum2 < energy2 * b:
        a, c = c, a
    rate = np.sqrt((c - b) * (momentum2 - energy2 * a) / (a * b * c))
    k2 = (b - a) * (energy2 * c - momentum2) / ((c - b) * (momentum2 - energy2 * a))
    x, y = 1.0, float(np.sqrt(1 - k2))
    while abs(x - y) > 1e-16:
        x, y = (x + y) / 2, float(np.sqrt(x * y))
    return float(2 * np.pi / (x * rate))


def run(settings: Settings) -> Measurement:
    """Angular momentum at all times, and the mean time between two turns the same way."""
    body = Body("body", (), 1.0, (0, 0, 0), inertia=MOMENTS, omega=OMEGA)
    scene = Scene((body,), gravity=(0, 0, 0), contacts=False)
    sim = build(scene, settings)
    mass = Mass(scene)
    want, first = flip_period(), mass.spin(sim)
    along, worst = [], 0.0
    for _ in range(int((PERIODS + 0.8) * want / sim.time_step)):
        sim.step()
        _, R, w, _ = mass.centers(sim)
        along.append(float(R[0][:, 1] @ w[0]))
        worst = max(worst, float(np.linalg.norm(mass.spin(sim) - first)))
    y = np.array(along)
    rising = np.flatnonzero((y[1:-2] < 0) & (y[2:-1] >= 0)) + 1
    found = float("nan")
    if len(rising) > 1:
        ends = [crossing(y[k - 1 : k + 3]) + k for k in (rising[0], rising[-1])]
        found = (ends[1] - ends[0]) * sim.time_step / (len(rising) - 1)
    return measured(
        sim,
        [
            Figure("angular momentum, relative error", finite(worst / float(np.linalg.norm(first))), "", 1e-10),
            Figure("period of the flips, relative error", finite(abs(found - want) / want), "", 1e-3),
        ],
    )


def plan(engine: str) -> list[Settings]:
    """Both integrators where there are two."""
    plain = steps(engine, (0.0005, 0.001, 0.002, 0.004), [""] if engine in (OURS, LANES, MUJOCO) else ["defaults"])
    rk4 = steps(engine, (0.0005, 0.001, 0.002, 0.004), [""], integrator="rk4") if engine in (OURS, MUJOCO) else []
    return rk4 + plain


CASES = [
    Case("torque-free spin", "a body about its middle axis", run, plan, lambda engine: plan(engine)[2:3], judge="curve")
]
