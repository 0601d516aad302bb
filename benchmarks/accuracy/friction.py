"""Own: a box on a slope, a disc that spins, a ball that rolls: closed forms."""

from functools import partial
from itertools import product

import numpy as np

from benchmarks.accuracy.case import Case, Figure, Measurement, Settings, once, steps
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.engines.base import OutOfTimeError
from benchmarks.accuracy.measures import finite, residuals
from benchmarks.accuracy.scene import Array, Body, G, Geom, Scene, ground

FRICTIONS = (0.1, 0.25, 0.5, 0.75, 1.0, 1.5)
DIRECTIONS = np.radians([0.0, 20.0, 45.0])
SWITCH = np.radians(0.1)
SLIDE = 1.0  # [s]
SLOPES = np.radians([2.0, 10.0])  # beyond the switch
DISC_RADIUS, SPIN_COEFFICIENT, SPIN = 0.1, 0.005, 5.0  # [m, m, rad/s]
BALL_RADIUS, ROLL_COEFFICIENT, ROLL = 0.1, 0.002, 0.2  # [m, m, m/s]


def slope(friction: float, angle: float, direction: float) -> Scene:
    """Gravity leans instead of the ground."""
    lean = np.sin(angle) * np.array([np.cos(direction), np.sin(direction)])
    gravity = (G * lean[0], G * lean[1], -G * np.cos(angle))
    box = Body("box", (Geom("box", (0.1, 0.1, 0.02), friction),), 1.0, (0, 0, 0.02))
    return Scene((ground(friction), box), gravity=gravity)  # type: ignore[arg-type]


class Slopes:
    """Boxes on many slopes, and the worst of each figure."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.spent = self.simulated = 0.0
        self.residuals: dict[str, float] = {}

    def gained(self, friction: float, angle: float, direction: float) -> Array:
        """How much faster the box becomes in a second, half a second after it was put down (2) [m/s]."""
        sim = build(slope(friction, angle, direction), self.settings)
        sim.run(SLIDE / 2, SLIDE)
        before = sim.states(["box"])[3][0]
        sim.run(SLIDE, SLIDE)
        after = sim.states(["box"])[3][0]
        self.spent, self.simulated = self.spent + sim.spent, self.simulated + sim.time
        for name, value in residuals(sim, 1).items():
            self.residuals[name] = max(self.residuals.get(name, 0.0), value)
        if self.spent > self.settings.budget:
            raise OutOfTimeError(f"stopped after {self.spent:.0f} s of the processor")
        return (after - before)[:2]


def incline(settings: Settings) -> Measurement:
    """Stick and slide on both sides of arctan(friction), and the closed form's acceleration, along every direction."""
    slopes = Slopes(settings)
    wrong, worst, aside = 0, 0.0, 0.0
    for friction, direction in product(FRICTIONS, DIRECTIONS):
        limit = np.arctan(friction)
        along = np.array([np.cos(direction), np.sin(direction)])

        def slide(beyond: float, mu: float = friction, limit: float = limit) -> float:
            return SLIDE * G * (np.sin(limit + beyond) - mu * np.cos(limit + beyond))

        just = slide(SWITCH)
        wrong += float(np.linalg.norm(slopes.gained(friction, limit - SWITCH, direction))) > 0.01 * just
        wrong += abs(float(slopes.gained(friction, limit + SWITCH, direction) @ along) - just) > 0.5 * just
        for beyond in SLOPES:
            want, gained = slide(beyond), slopes.gained(friction, limit + beyond, direction)
            worst = max(worst, float(np.linalg.norm(gained - want * along)) / want)
            aside = max(aside, abs(float(gained @ np.array([-along[1], along[0]]))) / want)
    return Measurement(
        [
            Figure("acceleration, relative error", finite(worst), "", 0.01),
            Figure(
                f"slopes 0.1° off the switch that are wrong, of {2 * len(FRICTIONS) * len(DIRECTIONS)}",
                float(wrong),
                "",
                0,
            ),
            Figure("acceleration across the slope, relative", finite(aside), "", 0.01),
        ],
        slopes.simulated / max(slopes.spent, 1e-9),
        slopes.residuals,
    )


def stopping(scene: Scene, name: str, want: float, settings: Settings) -> Measurement:
    """Time until the body's spin is below a thousandth of the first, extrapolated from the last stretch before it."""
    sim = build(scene, settings)
    first = float(np.linalg.norm(sim.states([name])[2][0]))
    times, speeds = [0.0], [first]

    def look() -> None:
        times.append(sim.time)
        speeds.append(float(np.linalg.norm(sim.states([name])[2][0])))

    sim.run(1.5 * want, look=look)
    t, w = np.array(times), np.array(speeds)
    braking = (w > 0.2 * first) & (w < 0.8 * first)
    if w[-1] > 0.01 * first or braking.sum() < 3:
        still = Figure("stopping time, relative error", finite(w[-1] / first), "", 0.02)
        return Measurement([still], sim.rtf, residuals(sim), "never stops; the figure is the part of its spin it keeps")
    rate, offset = np.polyfit(t[braking], w[braking], 1)
    error = abs(-offset / rate - want) / want
    stopped = t[np.argmax(w < 0.01 * first)]
    late = max(0.0, float(stopped) - want) / want
    rtf = sim.rtf
    return Measurement(
        [Figure("stopping time, relative error", finite(max(error, late)), "", 0.02)], rtf, residuals(sim)
    )


def disc(settings: Settings) -> Measurement:
    """No sliding friction: torque c m g brakes the moment of inertia m r^2 / 2."""
    body = Body(
        "disc",
        (Geom("cylinder", (DISC_RADIUS, 0.02), 0.0, product_friction=1.0),),
        1.0,
        (0, 0, 0.02),
        omega=(0, 0, SPIN),
    )
    scene = Scene((ground(0.0, spin=SPIN_COEFFICIENT, product_friction=0.0), body))
    return stopping(scene, "disc", DISC_RADIUS**2 / 2 * SPIN / (SPIN_COEFFICIENT * G), settings)


def rolling_ball(settings: Settings) -> Measurement:
    """Without slip: torque c m g brakes the moment of inertia 7/5 m r^2 about the contact."""
    body = Body(
        "ball",
        (Geom("sphere", (BALL_RADIUS,), 1.0, product_friction=1.0),),
        1.0,
        (0, 0, BALL_RADIUS),
        velocity=(ROLL, 0, 0),
        omega=(0, ROLL / BALL_RADIUS, 0),
    )
    scene = Scene((ground(1.0, spin=SPIN_COEFFICIENT, roll=ROLL_COEFFICIENT, product_friction=1.0), body))
    return stopping(scene, "ball", 1.4 * BALL_RADIUS * ROLL / (ROLL_COEFFICIENT * G), settings)


CASES = [
    Case("incline", "a box on slopes about arctan(friction)", incline, steps, partial(once, time_step=0.004)),
    Case("spinning disc", "stops by torsional friction", disc, steps, once),
    Case("rolling ball", "stops by rolling friction", rolling_ball, steps, once),
]
