"""Kinematics of a model: where frames are, how they move, and which configurations bring them to a goal.

Every function of a state takes a single one, q (nq,), or n of them as rows, q (n, nq); results have the rows in front.
If all arrays are float32 the states run side by side in SIMD lanes; otherwise everything is float64, the reference.

Units are SI; the world's z is up; quaternions are xyzw and must be of unit length in q; spatial vectors have the
angular part first. `Model` says what q and v mean for each type of joint. `frame` is the name of a link or frame.
Wrong shapes, NaN and infinities raise ValueError, which names the array; an unknown frame raises KeyError.

The forms of a velocity: "mixed" is that of the frame's origin in world axes, "space" that of the point of the body at
the world's origin in world axes, "body" that of the frame's origin in the frame's axes.
"""

from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands._core import kinematics as _core
from manyhands.arguments import FloatArray, choice, finite_row, finite_rows, float_arrays, instance, number
from manyhands.ik import IkResult, inverse, inverse_all, inverse_kinematics
from manyhands.rigid_motions import ad, adjoint, exp3, exp6, log3, log6, matrix, pose, unit_quaternions
from manyhands.workspace import Workspace, workspace

__all__ = [
    "Form",
    "IkResult",
    "Manipulability",
    "ScrewAxes",
    "Workspace",
    "ad",
    "adjoint",
    "exp3",
    "exp6",
    "forward",
    "inverse",
    "inverse_all",
    "inverse_kinematics",
    "is_singular",
    "jacobian",
    "jacobian_derivative",
    "log3",
    "log6",
    "manipulability",
    "matrix",
    "pose",
    "product_of_exponentials",
    "screw_axes",
    "screw_coordinates",
    "workspace",
]

Form: TypeAlias = Literal["mixed", "space", "body"]
Part: TypeAlias = Literal["linear", "angular", "all"]


def forward(model: Model, q: ArrayLike, frame: str) -> tuple[FloatArray, FloatArray]:
    """The pose in the world of a frame at q (..., nq): position (..., 3) [m], quaternion xyzw (..., 4)."""
    (q,) = float_arrays(q=q)
    return _core.forward(model, q, frame)


def jacobian(model: Model, q: ArrayLike, frame: str, form: Form = "mixed") -> FloatArray:
    """J (..., 6, nv) of a frame at q (..., nq): J v is its spatial velocity [rad/s, m/s] in the form asked for."""
    (q,) = float_arrays(q=q)
    return _core.jacobian(model, q, frame, form)


def jacobian_derivative(model: Model, q: ArrayLike, v: ArrayLike, frame: str, form: Form = "mixed") -> FloatArray:
    """dJ/dt (..., 6, nv) of the same while the model moves with v (..., nv): J dv/dt + dJ/dt v is the derivative of the
    frame's velocity, which in the mixed form is the acceleration of its origin [rad/s², m/s²]."""
    q, v = float_arrays(q=q, v=v)
    return _core.jacobian_derivative(model, q, v, frame, form)


class Manipulability(NamedTuple):
    """How well joints move a frame: joint velocities of length 1 move it in an ellipsoid. m is 3, or 6 of "all"."""

    measure: FloatArray
    """(...) the ellipsoid's volume but for a constant: sqrt(det(J Jᵀ))"""
    condition: FloatArray
    """(...) its longest semi-axis over the shortest; infinite where a direction is lost"""
    isotropy: FloatArray
    """(...) 1 / condition: 1 for a ball, 0 where a direction is lost"""
    lengths: FloatArray
    """(..., m) of the semi-axes, falling"""
    axes: FloatArray
    """(..., m, m) their directions as columns, in world axes"""


def manipulability(model: Model, q: ArrayLike, frame: str, part: Part = "linear") -> Manipulability:
    """Yoshikawa's measure (Int. J. Robotics Research 4(2), 1985) and the ellipsoid of a frame at q (..., nq), of its
    linear velocity, its angular velocity, or both at once, where metres and radians count alike."""
    (q,) = float_arrays(q=q)
    return Manipulability(*_core.manipulability(model, q, frame, part))


def is_singular(
    model: Model, q: ArrayLike, frame: str, part: Part = "all", *, tolerance: float = 1e-3
) -> NDArray[np.bool_]:
    """Whether at q (..., nq) the frame is about to lose a direction: the isotropy is below `tolerance`."""
    lost = number("tolerance", tolerance, above=0, most=1)
    return np.asarray(manipulability(model, q, frame, part).isotropy < lost)


class ScrewAxes(NamedTuple):
    """A model as screws: the pose of a frame at a home configuration, and there the axis of every dof."""

    position: NDArray[np.float64]
    """(3,) of the frame at home [m]"""
    quaternion: NDArray[np.float64]
    """(4,) xyzw"""
    axes: NDArray[np.float64]
    """(6, nv) as columns, angular first; zero for dofs that do not move the frame"""
    joint: NDArray[np.int32]
    """(nv,) whose axis it is: the axes of one joint turn at once; `np.arange(nv)` if all turn one after the other"""
    form: Form
    """"space" or "body\""""


def _home(model: Model, q0: ArrayLike | None) -> NDArray[np.float64]:
    nq = instance("model", model, Model).nq
    return finite_row("q0", model.neutral_configuration() if q0 is None else q0, nq)


def screw_axes(
    model: Model, frame: str, q0: ArrayLike | None = None, form: Literal["space", "body"] = "space"
) -> ScrewAxes:
    """The screw axes of any model at the home configuration q0 (nq,), by default the neutral one."""
    chosen = choice("form", form, "space", "body")
    position, quaternion, axes, joint = _core.screw_axes(model, frame, _home(model, q0), chosen)
    return ScrewAxes(position, quaternion, axes.T, joint, form)


def screw_coordinates(model: Model, q: ArrayLike, q0: ArrayLike | None = None) -> NDArray[np.float64]:
    """How far each screw turns from q0 (nq,) to q (..., nq): (..., nv). Of joints with one degree of freedom that is
    q - q0, of others the logarithm of the joint's displacement."""
    home = _home(model, q0)
    rows = finite_rows("q", q, model.nq)
    found: Any = _core.screw_coordinates(model, np.atleast_2d(rows.reshape(-1, model.nq)), home)
    return found.reshape(*rows.shape[:-1], model.nv)


def product_of_exponentials(screws: ScrewAxes, theta: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The frame's pose, position (..., 3) and quaternion (..., 4), after the screws have turned by theta (..., nv):
    `forward` by another way (Lynch, Park: Modern Robotics, 2017, chapter 4)."""
    instance("screws", screws, ScrewAxes, hint="as screw_axes gives them")
    turns = finite_rows("theta", theta, np.shape(screws.axes)[-1])
    flat = np.ascontiguousarray(turns.reshape(-1, turns.shape[-1]))
    axes = np.ascontiguousarray(finite_rows("axes", screws.axes, 6, turns.shape[-1]).T)
    joint = np.asarray(screws.joint, np.int32)
    if axes.ndim != 2 or joint.shape != axes.shape[:1]:
        raise ValueError(f"axes have shape {np.shape(screws.axes)} and joint {joint.shape}; expected (6, n) and (n,)")
    home = finite_rows("position", screws.position, 3), unit_quaternions("quaternion", screws.quaternion)
    if home[0].ndim != 1 or home[1].ndim != 1:
        raise ValueError("the screws' position and quaternion must be a single pose, (3,) and (4,)")
    position, quaternion = _core.product_of_exponentials(*home, axes, joint, screws.form, flat)
    return position.reshape(*turns.shape[:-1], 3), quaternion.reshape(*turns.shape[:-1], 4)
