"""Every public symbol says what it is: docstrings in Python, comments in C++ headers."""

import importlib
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import manyhands as mh

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT))

from tools.site.cpp_reference import public_headers  # noqa: E402
from tools.site.cpp_symbols import Symbol, read_header  # noqa: E402

MODULES = [
    "manyhands", "manyhands.collision", "manyhands.control", "manyhands.demos", "manyhands.dynamics", "manyhands.envs",
    "manyhands.experts", "manyhands.kinematics", "manyhands.learn", "manyhands.perception", "manyhands.planning",
    "manyhands.planning.online", "manyhands.plots", "manyhands.policies", "manyhands.recording", "manyhands.textures",
    "manyhands.video", "manyhands.viewer", "manyhands.vision", "manyhands.world_envs",
]  # fmt: skip
# What compiled functions and named tuples say of themselves where nobody else did.
BY_THEMSELVES = re.compile(r"\(self\) -> .*|Alias for field number \d+|Initialize self\..*|(\w+)\(.*\)( -> .*)?")


def says_something(text: str | None) -> bool:
    """Whether a docstring has a line that a person wrote."""
    return any(line.strip() and not BY_THEMSELVES.fullmatch(line.strip()) for line in (text or "").splitlines())


def public_names(module: ModuleType) -> Iterator[tuple[str, Any]]:
    names = getattr(module, "__all__", None) or [name for name in vars(module) if not name.startswith("_")]
    for name in names:
        found = getattr(module, name)
        is_ours = str(getattr(found, "__module__", "")).startswith("manyhands")
        if is_ours and (inspect.isclass(found) or callable(found)):
            yield name, found


def without_docstring(module: ModuleType) -> Iterator[str]:
    if not says_something(module.__doc__):
        yield module.__name__
    for name, found in public_names(module):
        if not says_something(inspect.getdoc(found)):
            yield f"{module.__name__}.{name}"
        if not inspect.isclass(found):
            continue
        for member, value in vars(found).items():
            text = value.__doc__ if isinstance(value, property) else inspect.getdoc(getattr(found, member, None))
            is_part = isinstance(value, property) or callable(getattr(value, "__func__", value))
            if not member.startswith("_") and is_part and not says_something(text):
                yield f"{module.__name__}.{name}.{member}"


@pytest.mark.parametrize("name", MODULES)
def test_python_has_docstrings(name: str) -> None:
    assert list(without_docstring(importlib.import_module(name))) == []


def test_the_reference_has_every_name() -> None:
    folder = ROOT / "docs/site/reference/modules"
    pages = "\n".join(page.read_text() for page in folder.glob("*.rst"))
    listed = set(re.findall(r":: manyhands\.([\w.]+)", pages))
    elsewhere = {"IkResult", "inverse_kinematics", "policy", "__version__"}  # of modules that are listed
    assert sorted(set(mh.__all__) - listed - elsewhere) == []


def without_comment(path: Path) -> Iterator[str]:
    """Classes, enumerations, concepts and functions of which a header says nothing: neither at the place, nor in its
    first comment if it declares nothing else, nor above for a group."""
    header = read_header(path)
    types = [symbol for symbol in header.symbols if symbol.kind in ("class", "struct", "enum", "concept")]
    for symbol in header.symbols:
        is_subject = symbol in types[:1] and header.summary
        is_arithmetic = symbol.kind == "function" and "/math/" in path.as_posix()  # dot, cross, sqrt: the names say it
        if not (symbol.comment or is_subject or is_arithmetic or speaks_for_itself(symbol)):
            yield f"{path.relative_to(ROOT)}:{symbol.line}: {symbol.name}"


def speaks_for_itself(symbol: Symbol) -> bool:
    """Operators, names for types, constants; and structs whose every field is told."""
    if symbol.kind in ("type", "variable", "concept") or symbol.name.startswith("operator"):
        return True
    return bool(symbol.members) and all(member.comment for member in symbol.members)


def test_cpp_headers_have_comments() -> None:
    headers = public_headers(ROOT)
    assert len(headers) > 200
    assert [line for path in headers for line in without_comment(path)] == []
