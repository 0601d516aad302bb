"""An arm that is known as screws and inertias, as a `Model` of manyhands: its dynamics are C++ then."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands import kinematics
from manyhands._core import Model, ModelBuilder

Array = NDArray[np.float64]

TIP = "tip"
"""The frame of a serial model's end effector."""

_SMALL = 1e-9


def serial_model(
    home: Array,
    screws: Array,
    inertias: list[Array] | None = None,
    centres: list[Array] | None = None,
    limits: list[tuple[float | None, float | None]] | None = None,
    gravity: Array | None = None,
) -> Model:
    """The model whose joints turn about, or slide along, `screws` (6, n), one after the other, in the space form.

    home: (4, 4) of the end effector. inertias: n spatial inertias (6, 6), angular first, of the links after the joints,
    each at a pose (4, 4) of `centres`, at home. limits: of the joints; None is none. Raises ValueError where a screw is
    neither a pure turn nor a pure shift of unit length.
    """
    n = screws.shape[1]
    builder = ModelBuilder("serial arm")
    if gravity is not None:
        builder.set_gravity(gravity)
    last, before = "world", np.zeros(3)
    for k in range(n):
        axis, point, kind = _joint_of(k, screws[:, k])
        name = f"link{k + 1}"
        builder.add_link(name, **_inertial(k, inertias, centres, point))
        low, high = (-np.inf, np.inf) if limits is None else limits[k]
        builder.add_joint(
            f"joint{k + 1}",
            kind,
            last,
            name,
            position=point - before,
            axis=axis,
            lower=-np.inf if low is None else low,
            upper=np.inf if high is None else high,
        )
        last, before = name, point
    position, quaternion = kinematics.pose(home)
    builder.add_frame(TIP, last, position=position - before, quaternion=quaternion)
    return builder.build()


def _joint_of(k: int, screw: Array) -> tuple[Array, Array, str]:
    """Axis, a point on it, and the kind of joint."""
    omega, v = screw[:3], screw[3:]
    turn, shift = np.linalg.norm(omega), np.linalg.norm(v)
    if abs(turn - 1) < 1e-6 and abs(omega @ v) < 1e-6:
        return omega, np.cross(omega, v), "revolute"
    if turn < _SMALL and abs(shift - 1) < 1e-6:
        return v, np.zeros(3), "prismatic"
    raise ValueError(f"screw {k} is {screw}; expected a unit turn or a unit shift, angular part first")


def _inertial(k: int, inertias: list[Array] | None, centres: list[Array] | None, origin: Array) -> dict[str, Any]:
    """Mass, centre and inertia of link k, whose frame is at `origin` with the axes of space, at home."""
    if inertias is None:
        return {"mass": 1.0, "inertia": np.eye(3)}
    G = np.asarray(inertias[k], np.float64)
    pose = np.eye(4) if centres is None else np.asarray(centres[k], np.float64)
    if centres is None:
        pose[:3, 3] = origin
    mass = float(G[3, 3])
    if mass <= 0:
        return {"mass": 0.0}
    R = pose[:3, :3]
    moment = np.array([G[2, 4], G[0, 5], G[1, 3]])  # of the upper right block, skew(m c)
    centre = moment / mass
    about = G[:3, :3] - mass * ((centre @ centre) * np.eye(3) - np.outer(centre, centre))
    turned = R @ about @ R.T
    return {"mass": mass, "com": R @ centre + pose[:3, 3] - origin, "inertia": (turned + turned.T) / 2}
