"""How good a response is, how far a loop is from instability, and gains to begin with."""

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from manyhands._core import control as _control
from manyhands.arguments import choice, finite_rows, number

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
    begin = (float(x[0]) if len(x) else 0.0) if start is None else number("start", start)
    end, band = number("set_point", set_point), number("tolerance", tolerance, above=0)
    return StepResponse(*_core.step_response(t, x, end, begin, band))


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
    return StabilityMargins(*_core.stability_margins(*polynomials, number("delay", delay, least=0)))


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
    gain, period = number("ultimate_gain", ultimate_gain, above=0), number("ultimate_period", ultimate_period, above=0)
    rules = {"P": (0.5, 0.0, 0.0), "PI": (0.45, 1.2, 0.0), "PD": (0.8, 0.0, 0.125), "PID": (0.6, 2.0, 0.125)}
    share, integral, derivative = rules[choice("kind", kind, *rules)]
    kp = share * gain
    return PidGains(kp, kp * integral / period, kp * derivative * period)
