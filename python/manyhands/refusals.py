"""What was wrong with arguments that the extension module refuses; bindings/refusals.cpp asks for it."""

import ast
import os
import re
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, Signature
from typing import Any, SupportsFloat, SupportsIndex

import numpy as np

from manyhands.arguments import brief

_ARRAY = re.compile(r"ndarray\[dtype=(\w+)[^\]]*\]")
_DEFAULT = re.compile(r"\\=?(\d+)")


def refusal(
    function: Any, args: Sequence[Any], kwargs: Mapping[str, Any], vector: tuple[Any, int] | None
) -> ValueError | TypeError:
    """The error to raise for a call of a bound function that none of its signatures takes.

    vector: one of the arguments, and how many numbers it should be, if nanobind stumbled there.
    """
    signatures = signatures_of(function)
    setter = _name_of_setter(function, args)
    where = setter or function.__qualname__.removesuffix(".__init__")
    reason, shown = "", ""
    for signature in signatures:
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as mismatch:
            reason = reason or str(mismatch)
            continue
        given.pop("self", None)
        shown = shown or ", ".join(f"{name}={brief(value)}" for name, value in given.items())
        for name, value in given.items():
            label = setter or f"{where}: {name}"
            if vector is not None and value is vector[0] and (error := _no_vector(label, *vector)):
                return error
            expected = signature.parameters[name].annotation
            if not _fits(value, ast.parse(expected, mode="eval").body):
                return TypeError(f"{label} is {brief(value)}; expected {_plain(expected)}")
    takes = " or ".join(_names_alone(signature) for signature in signatures)
    return TypeError(f"{where}: {reason or f'{shown} does not fit'}; it takes {takes}")


def signatures_of(function: Any) -> list[Signature]:
    """How a bound function may be called: one for each of its overloads."""
    return [_signature(text, defaults) for text, _, defaults in function.__nb_signature__]


def _signature(text: str, defaults: Sequence[Any] | None) -> Signature:
    """Of a function as nanobind writes it for stubs: Python, but for arrays' types, numbers that stand for defaults,
    and setters without a name."""
    text = _ARRAY.sub(r"numpy.typing.NDArray[numpy.\1]", text)
    text = _DEFAULT.sub(r"defaults[\1]", text)
    (function,) = ast.parse(f"def function{text[text.index('(') :]}: ...").body
    assert isinstance(function, ast.FunctionDef)
    given = function.args
    by_position = [*given.posonlyargs, *given.args]
    positional = [None] * (len(by_position) - len(given.defaults)) + given.defaults
    kinds = [Parameter.POSITIONAL_ONLY] * len(given.posonlyargs) + [Parameter.POSITIONAL_OR_KEYWORD] * len(given.args)
    rows = [*zip(kinds, by_position, positional, strict=True)]
    rows += [(Parameter.KEYWORD_ONLY, *row) for row in zip(given.kwonlyargs, given.kw_defaults, strict=True)]
    rows += [(Parameter.VAR_KEYWORD, given.kwarg, None)] if given.kwarg is not None else []
    parameters = [
        Parameter(
            argument.arg,
            kind,
            default=Parameter.empty if default is None else _value(default, defaults or ()),
            annotation="Any" if argument.annotation is None else ast.unparse(argument.annotation),
        )
        for kind, argument, default in rows
    ]
    return Signature(parameters)


def _value(default: ast.expr, numbered: Sequence[Any]) -> Any:
    """What a default is: a literal, or one of those that nanobind numbers."""
    if isinstance(default, ast.Subscript):
        return numbered[ast.literal_eval(default.slice)]
    return ast.literal_eval(default)


def _name_of_setter(function: Any, args: Sequence[Any]) -> str:
    """Of the property that the function sets, if it is a setter."""
    for kind in type(args[0]).__mro__ if args else ():
        for name, member in vars(kind).items():
            if isinstance(member, property) and member.fset is function:
                return f"{kind.__name__}.{name}"
    return ""


def _no_vector(label: str, value: Any, expected: int) -> ValueError | TypeError | None:
    """None if it is one: nanobind tries again where it stumbled, with conversions."""
    if not _is_numbers(value) or np.ndim(value) != 1:
        return TypeError(f"{label} is {brief(value)}; expected {expected} numbers")
    if (length := len(value)) != expected:
        return ValueError(f"{label} has {length} number{'s' if length != 1 else ''}; expected {expected}")
    return None


def _is_numbers(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind in "biuf"
    except ValueError:  # rows of several lengths
        return False


def _fits(value: Any, expected: ast.expr) -> bool:
    """Whether a value is of the annotated type, as far as this can be told: True where it is not known."""
    if isinstance(expected, ast.BinOp):
        return _fits(value, expected.left) or _fits(value, expected.right)
    of = expected.slice if isinstance(expected, ast.Subscript) else None
    name = ast.unparse(expected.value if isinstance(expected, ast.Subscript) else expected).rpartition(".")[2]
    match name:
        case "None":
            return value is None
        case "Any" | "object" | "Literal":
            return True
        case "ArrayLike":
            return _is_numbers(value)
        case "NDArray":
            return isinstance(value, np.ndarray) and _is_numbers(value) and value.ndim > 0
        case "Sequence":
            is_list = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str | bytes)
            return is_list and (of is None or all(_fits(item, of) for item in value))
        case _ if name in _TYPES:
            return isinstance(value, _TYPES[name])
    return name in [kind.__name__ for kind in type(value).__mro__]


_TYPES: dict[str, Any] = {
    "int": SupportsIndex,
    "float": SupportsFloat | SupportsIndex,
    "bool": bool | np.bool_,
    "PathLike": os.PathLike,
    "Mapping": Mapping,
    "Callable": Callable,
}


def _plain(annotation: str) -> str:
    """Without the modules: 'float | Sequence[float]'."""
    return re.sub(r"(?:\w+\.)+(\w+)", r"\1", annotation)


def _names_alone(signature: Signature) -> str:
    parameters = [p.replace(annotation=p.empty) for name, p in signature.parameters.items() if name != "self"]
    return str(Signature(parameters))
