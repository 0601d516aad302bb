"""Controllers: what joints are to do so that a robot follows, yields, pushes and stands, and how good that is.

Functions of a state take a single one, q (nq,), or n of them as rows, q (n, nq), and the other arrays likewise; results
have the rows in front. If all arrays are float32 the rows run side by side in SIMD lanes; otherwise everything is
float64, the reference. Gains are one number, or one for each dof, (nv,). Joints have one degree of freedom each; a
model with others raises RuntimeError. Wrong shapes, NaN and infinite numbers raise ValueError, which names the array;
an unknown frame raises KeyError.

Units are SI; the world's z is up; quaternions are xyzw; spatial vectors have the angular part first.
"""

from manyhands.control.frames import Admittance, impedance, operational_space
from manyhands.control.joints import (
    Adaptive,
    Pid,
    computed_torque,
    gravity_torque,
    limited,
    pd_feedforward,
    pd_gravity,
    rate_limited,
    sliding_mode,
)
from manyhands.control.kalman import KalmanFilter
from manyhands.control.responses import (
    PidGains,
    StabilityMargins,
    StepResponse,
    stability_margins,
    step_response,
    ziegler_nichols,
)

__all__ = [
    "Adaptive",
    "Admittance",
    "KalmanFilter",
    "Pid",
    "PidGains",
    "StabilityMargins",
    "StepResponse",
    "computed_torque",
    "gravity_torque",
    "impedance",
    "limited",
    "operational_space",
    "pd_feedforward",
    "pd_gravity",
    "rate_limited",
    "sliding_mode",
    "stability_margins",
    "step_response",
    "ziegler_nichols",
]
