"""What a case is: a run under some settings, the figures it gives, and the settings it is swept over."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from benchmarks.accuracy.engines.base import Settings, Simulation

OURS, LANES, MUJOCO, BULLET = "manyhands", "manyhands lanes", "MuJoCo", "PyBullet"
ENGINES = (OURS, LANES, MUJOCO, BULLET)
VARIANTS = {
    OURS: ("",),
    LANES: ("",),
    MUJOCO: ("elliptic, impratio 10", "stiff, noslip 10"),
    BULLET: ("defaults", "200 sweeps"),
}
TIME_STEPS = (0.0005, 0.001, 0.002, 0.004, 0.008, 0.016)
ITERATIONS = (5, 20, 100, 500)
PUBLISHED_STEP = 0.001  # at which iterations are swept


@dataclass(frozen=True)
class Figure:
    """One number and what it must not exceed."""

    metric: str
    value: float | None  # None: not finite
    unit: str
    bound: float | None = None
    bound_rtf: float | None = None  # the bound must be met at this real-time factor


@dataclass
class Measurement:
    """All that one run gave."""

    figures: list[Figure]
    rtf: float
    residuals: dict[str, float] = field(default_factory=dict)
    note: str = ""


@dataclass(frozen=True)
class Best:
    """A published point: error at a real-time factor, where one was published."""

    who: str
    error: float
    rtf: float | None


@dataclass(frozen=True)
class Case:
    """`run` measures; the plans say with what settings."""

    name: str
    title: str
    run: Callable[[Settings], Measurement]
    plan: Callable[[str], Sequence[Settings]]  # of an engine
    quick: Callable[[str], Sequence[Settings]] = lambda engine: ()
    published: tuple[Best, ...] = ()  # of the first figure
    judge: str = "steps"  # "steps": all at 2 and 4 ms with default iterations; "curve": one point is enough
    curve: bool = False  # a speed-accuracy curve is drawn


def steps(
    engine: str,
    time_steps: Sequence[float] = (0.002, 0.004),
    variants: Sequence[str] | None = None,
    options: dict[str, dict[str, Any]] | None = None,
    **more: Any,
) -> list[Settings]:
    """Default iterations at each time step, for every variant of the engine."""
    own = (options or {}).get(engine, {})
    return [
        Settings(engine, h, variant=variant, options=own, **more)
        for variant in (VARIANTS[engine] if variants is None else variants)
        for h in time_steps
    ]


def cross(
    engine: str, options: dict[str, dict[str, Any]] | None = None, variants: Sequence[str] | None = None
) -> list[Settings]:
    """Every time step at default iterations, and every number of iterations at the published step.

    PyBullet's variants differ in their iterations alone, which are swept anyway.
    """
    chosen = variants if variants is not None else VARIANTS[engine] if engine == MUJOCO else VARIANTS[engine][:1]
    (first,) = steps(engine, [PUBLISHED_STEP], chosen[:1], options)
    return steps(engine, TIME_STEPS, chosen, options) + [replace(first, iterations=n) for n in ITERATIONS]


def once(engine: str, time_step: float = 0.002, **more: Any) -> list[Settings]:
    """One run with the engine's first variant: for `--quick`."""
    return steps(engine, [time_step], VARIANTS[engine][:1], **more)


def measured(sim: Simulation, figures: list[Figure], residuals: dict[str, float] | None = None) -> Measurement:
    """With the simulation's own clock."""
    return Measurement(figures, sim.rtf, residuals or {})
