"""Arguments that the extension module refuses: the message names what was wrong, and what is expected."""

import ast
import inspect
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import manyhands as mh
from manyhands import _core, refusals


def world() -> mh.World:
    result = mh.World()
    result.add_box("box", [0.1, 0.1, 0.1])
    return result


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: world().add_box("c", [1, 2]), "World.add_box: size has 2 numbers; expected 3"),
        (lambda: world().add_box("c", np.ones(4)), "World.add_box: size has 4 numbers; expected 3"),
        (lambda: world().add_box("c", [1, 1, 1], position=[1]), "World.add_box: position has 1 number; expected 3"),
        (lambda: world().add_sphere("c", 1, 1, [0, 0, 0], [0, 0, 1]), "quaternion has 3 numbers; expected 4"),
        (lambda: setattr(world(), "gravity", [1]), "World.gravity has 1 number; expected 3"),
        (lambda: world().set_body_velocity("box", [1, 2]), "omega has 2 numbers; expected 3"),
        (lambda: world().apply_force("box", [1, 2, 3], point=[]), "point has 0 numbers; expected 3"),
        (lambda: mh.ModelBuilder("m").add_joint("j", "fixed", "a", "b", axis=[1, 0]), "axis has 2 numbers; expected 3"),
        (lambda: mh.Mark("box", [1, 1, 1], [0, 0, 0], rgba=[1, 0]), "Mark: rgba has 2 numbers; expected 4"),
        (lambda: mh.Look(light=[1, 0]), "Look: light has 2 numbers; expected 3"),
        (lambda: world().set_motors(target_q=[1], max_force=1), r"target_q has shape \(1,\); expected \(6,\)"),
    ],
)
def test_a_vector_of_another_length_says_how_long_it_is(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: world().add_box("c", 3), "World.add_box: size is 3; expected 3 numbers"),
        (lambda: world().add_box("c", [1, "a", 2]), r"size is \[1, 'a', 2\]; expected 3 numbers"),
        (lambda: world().add_box("c", [[1, 2, 3]]), r"size is \[\[1, 2, 3\]\]; expected 3 numbers"),
        (lambda: world().add_box("c", [1, 2, 3], "heavy"), "World.add_box: mass is 'heavy'; expected float"),
        (lambda: setattr(world(), "gravity", None), "World.gravity is None; expected ArrayLike"),
        (lambda: setattr(world(), "q", "abc"), r"World.q is 'abc'; expected Sequence\[float\] | NDArray\[floating\]"),
        (lambda: world().step(1.5), "World.step: n is 1.5; expected int"),
        (lambda: world().step(1, 2), r"World.step: too many positional arguments; it takes \(n=1\)"),
        (lambda: world().step(m=1), r"unexpected keyword argument 'm'; it takes \(n=1\)"),
        (lambda: world().set_motors(target_q=[1]), "World.set_motors: missing a required argument: 'max_force'"),
        (lambda: world().show(1), r"World.show: too many positional arguments; it takes \(\*\*options\)"),
        (lambda: world().restore(3), "World.restore: snapshot is 3; expected bytes"),
        (
            lambda: mh.Batch(world().model, 2).reset([True, False]),
            r"Batch.reset: mask is \[True, False\]; expected NDArray",
        ),
        (lambda: world().render(3), "World.render: camera is 3; expected Camera"),
        (lambda: world().add(3), r"World.add: model is 3; expected Model | ModelBuilder | str | PathLike"),
        (lambda: world().add_mesh("m", [[1, 2]]), r"World.add_mesh: mesh is \[\[1, 2\]\]; expected str"),
        (lambda: mh.World("x"), r"World: model is 'x'; expected Model \| None"),
        (lambda: mh.Batch(3, 3), "Batch: model is 3; expected Model"),
        (lambda: mh.load_urdf(3), r"load_urdf: path is 3; expected str \| PathLike"),
        (lambda: setattr(_core.learn.TrainerConfig(), "seed", "x"), "TrainerConfig.seed is 'x'; expected int"),
    ],
)
def test_a_value_of_another_type_is_named(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError, match=message) as refused:
        call()
    assert "incompatible function arguments" not in str(refused.value)


def test_what_raises_inside_a_call_keeps_its_message() -> None:
    class Name:
        def __fspath__(self) -> str:
            raise TypeError("not now")

    with pytest.raises(TypeError, match="path"):
        mh.load_urdf(Name())
    assert (world() == 3) is False


def bound(scope: Any, seen: set[int]) -> Iterator[Any]:
    """All functions of the extension module."""
    for member in vars(scope).values():
        if isinstance(member, property):
            yield from (part for part in (member.fget, member.fset) if hasattr(part, "__nb_signature__"))
        elif hasattr(member, "__nb_signature__"):
            yield member
        elif isinstance(member, ModuleType | type) and id(member) not in seen:
            seen.add(id(member))
            if getattr(member, "__module__", "manyhands._core").startswith("manyhands._core"):
                yield from bound(member, seen)


def test_the_signature_of_every_function_is_understood() -> None:
    functions = list(bound(_core, set()))
    assert len(functions) > 400
    for function in functions:
        for text, _, defaults in function.__nb_signature__:
            signature = refusals._signature(text, defaults)
            assert isinstance(signature, inspect.Signature)
            for name, parameter in signature.parameters.items():
                if name != "self":
                    refusals._fits(None, ast.parse(str(parameter.annotation), mode="eval").body)
