"""How fast a path can be followed."""

from numpy.typing import ArrayLike

from manyhands._core import Model
from manyhands._core import planning as _core
from manyhands.arguments import instance, number, whole_number
from manyhands.planning.trajectories import Trajectory, limit_row

_MOST_INTERVALS = 10_000


def time_optimal(
    path: Trajectory,
    *,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    model: Model | None = None,
    intervals: int = 200,
    start_speed: float = 0.0,
    end_speed: float = 0.0,
) -> Trajectory:
    """The fastest motion along a path within limits. Only the path's shape counts: its times are a parameter, s.

    velocity, acceleration, torque: (n,) or one for all, above 0; infinity and None do not limit. Torques [N m or N] are
    those of `model`, by inverse dynamics. intervals: of the path, in each of which the acceleration of s is constant;
    the pieces of the path add their own. start_speed, end_speed: ds/dt at the ends.

    Where the path turns sharply (a spline of degree 1) the motion stops. Raises ValueError on limits that do not fit,
    and where no motion keeps within them: the message says where on the path, and which speeds are possible.

    TOPP-RA: H. Pham and Q.-C. Pham, IEEE Transactions on Robotics 34(3), 2018.
    """
    n = instance("path", path, Trajectory).width
    limits = {"velocity": velocity, "acceleration": acceleration, "torque": torque}
    rows = {name: None if values is None else limit_row(name, values, n) for name, values in limits.items()}
    count = whole_number("intervals", intervals, 2, _MOST_INTERVALS)
    return Trajectory._of(
        _core.time_optimal(
            path._motion,
            rows["velocity"],
            rows["acceleration"],
            rows["torque"],
            model,
            count,
            number("start_speed", start_speed, least=0),
            number("end_speed", end_speed, least=0),
        )
    )
