"""Kinematics and dynamics of a model, for one state or many.

Every function takes a single state, q (nq,), or n of them as rows, q (n, nq), and the other arrays likewise; results
have the rows in front. If all arrays are float32 the states run side by side in SIMD lanes; otherwise everything is
float64, the reference. A row with NaN or infinity spoils its own results only.

Units are SI; the world's z is up; quaternions are xyzw and must be of unit length in q; spatial vectors have the
angular part first. `Model` says what q and v mean for each type of joint. A wrong shape raises ValueError, which names
the array; an unknown frame raises KeyError.

Algorithms: Featherstone, Rigid Body Dynamics Algorithms, 2008.
"""

from numpy.typing import ArrayLike

from manyhands._core import Model
from manyhands._core import dynamics as _core
from manyhands.arguments import FloatArray, float_arrays

__all__ = [
    "aba",
    "center_of_mass",
    "crba",
    "energy",
    "forward_kinematics",
    "frame_pose",
    "jacobian",
    "momentum",
    "rnea",
]


def rnea(model: Model, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> FloatArray:
    """Inverse dynamics: tau = M(q) a + C(q, v) v + g(q), the joint forces (..., nv) [N m or N] that give the
    acceleration a (..., nv) [rad/s² or m/s²] in the state q (..., nq), v (..., nv). Rotor inertia (armature) is
    included, damping and friction are not. Recursive Newton-Euler, table 5.1."""
    q, v, a = float_arrays(q=q, v=v, a=a)
    return _core.rnea(model, q, v, a)


def aba(model: Model, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> FloatArray:
    """Forward dynamics: the acceleration (..., nv) [rad/s² or m/s²] under the joint forces tau (..., nv) [N m or N] in
    the state q (..., nq), v (..., nv); the inverse of `rnea`. Articulated bodies, table 7.1."""
    q, v, tau = float_arrays(q=q, v=v, tau=tau)
    return _core.aba(model, q, v, tau)


def crba(model: Model, q: ArrayLike) -> FloatArray:
    """The joint-space inertia matrix M (..., nv, nv) at q (..., nq), symmetric, armature included [kg m² or kg].
    Composite rigid bodies, table 6.2."""
    (q,) = float_arrays(q=q)
    return _core.crba(model, q)


def frame_pose(model: Model, q: ArrayLike, frame: str) -> tuple[FloatArray, FloatArray]:
    """The pose in the world of a frame (or link) at q (..., nq): position (..., 3) [m], quaternion xyzw (..., 4)."""
    (q,) = float_arrays(q=q)
    return _core.frame_pose(model, q, frame)


def forward_kinematics(model: Model, q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """The poses in the world of all frames, in the order of `model.frames`, at q (..., nq): positions
    (..., num_frames, 3) [m], quaternions xyzw (..., num_frames, 4)."""
    (q,) = float_arrays(q=q)
    return _core.forward_kinematics(model, q)


def jacobian(model: Model, q: ArrayLike, frame: str) -> FloatArray:
    """J (..., 6, nv) of a frame (or link) at q (..., nq): J v is its angular velocity [rad/s], then the velocity of its
    origin [m/s], both in world axes."""
    (q,) = float_arrays(q=q)
    return _core.jacobian(model, q, frame)


def center_of_mass(model: Model, q: ArrayLike) -> FloatArray:
    """The centre of mass (..., 3) [m] in the world of all bodies that can move, at q (..., nq)."""
    (q,) = float_arrays(q=q)
    return _core.center_of_mass(model, q)


def momentum(model: Model, q: ArrayLike, v: ArrayLike) -> FloatArray:
    """The momentum (..., 6) about the world's origin of all bodies that can move, in the state q (..., nq),
    v (..., nv): angular [kg m²/s], linear [kg m/s]. Rotors (armature) are not included."""
    q, v = float_arrays(q=q, v=v)
    return _core.momentum(model, q, v)


def energy(model: Model, q: ArrayLike, v: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Kinetic energy (...), rotors included, and potential energy (...), 0 at the world's origin [J], in the state
    q (..., nq), v (..., nv)."""
    q, v = float_arrays(q=q, v=v)
    return _core.energy(model, q, v)
