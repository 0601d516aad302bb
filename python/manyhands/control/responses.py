"""How good a response is, how far a loop is from instability, and gains to begin with."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from manyhands._core import control as _control
from manyhands.arguments import finite_rows
from manyhands.control.joints import finite_numbers

_core: Any = _control  # its rows are unpacked, which overloads do not take


class StepResponse(NamedTuple):
    """Of a response to a step; what does not happen is infinite."""

    rise_time: float
    """between the first samples at 10 % and 90 % of the way [s]"""
    settling_time: float
    """from when on the error stays within the tolerance [s]"""
    peak: float
    """the farthest of all samples"""
    peak_time: float
    """[s]"""
    overshoot: float
    """by how much it goes beyond, as a share of the way; 0 if it does not"""
    steady_state_error: float
    """of the last sample: response - set_point"""


def step_response(
    time: ArrayLike, response: ArrayLike, set_point: float, *, start: float | None = None, tolerance: float = 0.02
) -> StepResponse:
    """Measures a response (n,) at times (n,) that rise [s], which is to go from `start`, by default its first sample,
    to set_point (Ogata, Modern Control Engineering, 2010, section 5-3). tolerance: as a share of the way."""
    t, x = finite_rows("time", time), finite_rows("response", response)
    if t.ndim != 1 or x.ndim != 1:
        raise ValueError(f"time has shape {t.shape} and response {x.shape}; expected (n,) both")
    begin = float(x[0]) if start is None and len(x) else float(start or 0.0)
    numbers = finite_numbers(set_point=set_point, start=begin, tolerance=tolerance)
    return StepResponse(*_core.step_response(t, x, *numbers))


class StabilityMargins(NamedTuple):
    """Of a loop closed by negative feedback; infinite where there is no crossover."""

    gain: float
    """the factor by which the gain may grow until the loop oscillates; of an unstable one, the factor nearest 1"""
    gain_frequency: float
    """at which it then oscillates; 0 or infinite if it drifts [rad/s]"""
    phase: float
    """the angle by which its phase may fall [rad]"""
    phase_frequency: float
    """where the gain is 1 [rad/s]"""
    stable: bool
    """whether the closed loop is; the margins of one that is not say what it lacks"""
    lower_gain: float
    """the factor below 1 to which the gain may fall until the loop oscillates; 0 if it may vanish"""
    lower_gain_frequency: float
    """at which it then oscillates [rad/s]"""


def stability_margins(numerator: ArrayLike, denominator: ArrayLike, *, delay: float = 0.0) -> StabilityMargins:
    """Of the loop L(s) = numerator(s) / denominator(s) exp(-delay s), coefficients of the highest power first, delay in
    seconds. A loop that is sampled every h and held behaves as one with a delay of h / 2 more. Look at `stable` first:
    where there is no crossover, the margins of an unstable loop are infinite too."""
    polynomials = [
        np.atleast_1d(finite_rows(*named)) for named in (("numerator", numerator), ("denominator", denominator))
    ]
    return StabilityMargins(*_core.stability_margins(*polynomials, *finite_numbers(delay=delay)))


class PidGains(NamedTuple):
    """Of a PID controller."""

    kp: float
    ki: float
    kd: float


def ziegler_nichols(
    ultimate_gain: float, ultimate_period: float, kind: Literal["P", "PI", "PD", "PID"] = "PID"
) -> PidGains:
    """Gains to begin with, from the gain at which a proportional loop oscillates and the period [s] with which it does
    (Ziegler, Nichols, Optimum settings for automatic controllers, Trans. ASME 64, 1942). `stability_margins` of a loop
    of gain 1 gives both: its gain margin, and 2 pi over its frequency."""
    if not (math.isfinite(ultimate_gain) and math.isfinite(ultimate_period) and ultimate_period > 0):
        raise ValueError(
            f"the gain is {ultimate_gain} and the period {ultimate_period}; expected finite numbers, the period above 0"
        )
    rules = {"P": (0.5, 0.0, 0.0), "PI": (0.45, 1.2, 0.0), "PD": (0.8, 0.0, 0.125), "PID": (0.6, 2.0, 0.125)}
    if kind not in rules:
        raise ValueError(f"kind is {kind!r}; expected one of {', '.join(rules)}")
    share, integral, derivative = rules[kind]
    kp = share * ultimate_gain
    return PidGains(kp, kp * integral / ultimate_period, kp * derivative * ultimate_period)
