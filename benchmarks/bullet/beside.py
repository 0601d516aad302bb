"""Both modules as one: a call goes to manyhands.pybullet and to the real one, and what they return is compared.

What was compared is remembered for docs/pybullet_coverage.md.
"""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any

import numpy as np
import pybullet as real
import pybullet_data

import manyhands.pybullet as ours

DATA = pybullet_data.getDataPath()
SINGLE = 2e-6
"""The tolerance unless a call names another: the real module computes much in single precision."""

# Parameters whose values have names: those of the module's constants that begin or end so.
NAMED = {
    "controlMode": ("_CONTROL",),
    "shapeType": ("GEOM_",),
    "shapeTypes": ("GEOM_",),
    "jointType": ("JOINT_",),
    "linkJointTypes": ("JOINT_",),
    "solver": ("IK_",),
    "renderer": ("ER_TINY", "ER_BULLET"),
    "jointFeedbackMode": ("JOINT_FEEDBACK_",),
    "activationState": ("ACTIVATION_STATE_",),
}
FLAGS = {
    "loadURDF": ("URDF_",),
    "createMultiBody": ("URDF_",),
    "getCameraImage": ("ER_",),
    "applyExternalForce": ("LINK_FRAME", "WORLD_FRAME"),
    "applyExternalTorque": ("LINK_FRAME", "WORLD_FRAME"),
    "getVisualShapeData": ("VISUAL_SHAPE_DATA_",),
    "changeVisualShape": ("VISUAL_SHAPE_DOUBLE",),
    "createCollisionShape": ("GEOM_",),
}
NEVER = {"GEOM_FORCE_CONCAVE_TRIMESH", "GEOM_CONCAVE_INTERNAL_EDGE", "ER_TINY_RENDERER", "ER_BULLET_HARDWARE_OPENGL"}


@dataclass
class Compared:
    """Of one function: what was given to it, and how far the results were apart."""

    options: set[str] = field(default_factory=set)
    refusals: set[str] = field(default_factory=set)
    calls: int = 0
    tolerance: float = 0.0
    distance: float = 0.0


RECORD: dict[str, Compared] = {}


class MismatchError(AssertionError):
    """The modules differ by more than the tolerance, or in kind."""


def distance(a: Any, b: Any, tolerance: float, where: str = "") -> float:
    """The largest difference of numbers, relative above 1. Raises MismatchError beyond the tolerance.

    Types, lengths, texts and whole numbers are the same exactly; quaternions up to their sign.
    """
    if type(a) is not type(b):
        raise MismatchError(f"{where}: {a!r} beside {b!r}")
    if isinstance(a, float):
        apart = abs(a - b) / max(1.0, abs(b))
        if not apart <= tolerance and a != b:
            raise MismatchError(f"{where}: {a!r} beside {b!r}, {apart:.1e} apart, tolerance {tolerance:.1e}")
        return 0.0 if a == b else apart
    if isinstance(a, tuple | list):
        if len(a) != len(b):
            raise MismatchError(f"{where}: {len(a)} beside {len(b)} entries: {a!r} beside {b!r}")
        if is_quaternion(a) and sum(x * y for x, y in zip(a, b, strict=True)) < 0:
            a = tuple(-x for x in a)
        pairs = zip(a, b, strict=True)
        return max((distance(x, y, tolerance, f"{where}[{i}]") for i, (x, y) in enumerate(pairs)), default=0.0)
    if isinstance(a, dict):
        if list(a) != list(b):
            raise MismatchError(f"{where}: {list(a)} beside {list(b)}")
        return max((distance(a[key], b[key], tolerance, f"{where}[{key!r}]") for key in a), default=0.0)
    if isinstance(a, np.ndarray):
        if a.dtype != b.dtype or a.shape != b.shape:
            raise MismatchError(f"{where}: {a.dtype} {a.shape} beside {b.dtype} {b.shape}")
        return distance(a.astype(float).ravel().tolist(), b.astype(float).ravel().tolist(), tolerance, where)
    if a != b:
        raise MismatchError(f"{where}: {a!r} beside {b!r}")
    return 0.0


def is_quaternion(a: Any) -> bool:
    """Whether these are four numbers of length 1."""
    return len(a) == 4 and all(isinstance(x, float) for x in a) and abs(sum(x * x for x in a) - 1) < 1e-5


class Beside:
    """A client of each module. Its methods are the module's functions; two words are its own.

    `within`: the tolerance. `view`: a function that makes of both results what is compared.
    """

    def __init__(self) -> None:
        self._unseen: set[str] = set()  # what was set and had no effect that was compared since
        for module in (ours, real):
            assert module.connect(module.DIRECT) == 0
            module.setAdditionalSearchPath(DATA)

    def close(self) -> None:
        """Ends both clients."""
        for module in (ours, real):
            module.disconnect()

    def unseen(self) -> set[str]:
        """Functions that set something after which no result was compared."""
        return self._unseen

    def __getattr__(self, name: str) -> Any:
        value = getattr(real, name)
        return partial(self._call, name) if callable(value) else value

    def _call(
        self, name: str, /, *args: Any, within: float = SINGLE, view: Callable[[Any], Any] | None = None, **options: Any
    ) -> Any:
        a, b = (getattr(module, name)(*args, **options) for module in (ours, real))
        try:
            apart = distance(*((view(a), view(b)) if view else (a, b)), within, name)
        except MismatchError:
            self._unseen.clear()
            raise
        one = note(name, args, options)
        one.calls += 1
        one.tolerance = max(one.tolerance, within if apart > 0 else 0.0)
        one.distance = max(one.distance, apart)
        is_question = name.startswith(("get", "is", "calculate", "compute", "ray"))
        if a in (None, ()) and not is_question:
            self._unseen.add(name)
        else:
            self._unseen.clear()
        return a

    def on_each(self, call: Callable[[Any], Any]) -> list[Any]:
        """The results of both modules, ours first, without a comparison."""
        return [call(module) for module in (ours, real)]

    def step(self, times: int) -> None:
        """Steps both."""
        for _ in range(times):
            self._call("stepSimulation")

    def refuses(self, name: str, /, *args: Any, **options: Any) -> None:
        """Both raise the same kind of exception, and our world is as it was to the bit."""
        before = state_of_ours()
        kinds = [kind_of_refusal(module, name, args, options) for module in (ours, real)]
        assert kinds[0] == kinds[1] and kinds[0] in ("error", "TypeError"), f"{name}: {kinds[0]} beside {kinds[1]}"
        assert state_of_ours() == before, f"{name} has changed something and then refused"
        RECORD.setdefault(name, Compared()).refusals.add(repr((args, options)))


def kind_of_refusal(module: Any, name: str, args: tuple[Any, ...], options: dict[str, Any]) -> str:
    """The exception of a call, or what it returned."""
    try:
        result = getattr(module, name)(*args, **options)
    except module.error:
        return "error"
    except TypeError:
        return "TypeError"
    return f"no exception but {result!r}"


def note(name: str, args: tuple[Any, ...], options: dict[str, Any]) -> Compared:
    """Remembers what was given to a function."""
    one = RECORD.setdefault(name, Compared())
    given = dict(zip(parameters(name), args, strict=False)) | options
    for parameter, value in given.items():
        one.options.add(parameter)
        one.options.update(f"{parameter}={constant}" for constant in constants(name, parameter, value))
    return one


@cache
def parameters(name: str) -> list[str]:
    """The names of a function's parameters."""
    return list(inspect.signature(getattr(ours, name)).parameters)


def given(name: str, one: Compared) -> set[str]:
    """The optional parameters and the constants among what was given to a function."""
    return {option for option in one.options if "=" in option or option in optional(name)}


@cache
def optional(name: str) -> set[str]:
    """Those that need not be given."""
    found = inspect.signature(getattr(ours, name)).parameters.values()
    return {one.name for one in found if one.default is not inspect.Parameter.empty}


def constants(name: str, parameter: str, value: Any) -> list[str]:
    """The names of the module's constants that stand for an argument's value, or its bits."""
    is_flag = parameter == "flags" and name in FLAGS
    marks = FLAGS[name] if is_flag else NAMED.get(parameter, ())
    found = []
    for constant in dir(real):
        if not any(constant.startswith(mark) or constant.endswith(mark) for mark in marks):
            continue
        if not is_flag and constant in NEVER:
            continue
        number = getattr(real, constant)
        if isinstance(value, list | tuple) if not isinstance(value, int) else False:
            found += [constant] if number in value else []
        elif (is_flag and value & number) or (not is_flag and value == number):
            found.append(constant)
    return found


def state_of_ours() -> list[Any]:
    """All that our module tells of its bodies and constraints."""
    told: list[Any] = [ours.getPhysicsEngineParameters(), ours.getNumConstraints()]
    for body in map(ours.getBodyUniqueId, range(ours.getNumBodies())):
        links = range(ours.getNumJoints(body))
        told += [body, ours.getBodyInfo(body), ours.getBasePositionAndOrientation(body), ours.getBaseVelocity(body)]
        told += [ours.getJointStates(body, links), ours.getVisualShapeData(body)]
        told += [ours.getDynamicsInfo(body, link) for link in (-1, *links)]
    told += [ours.getConstraintInfo(ours.getConstraintUniqueId(i)) for i in range(ours.getNumConstraints())]
    return told
