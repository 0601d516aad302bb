"""Reads the part of YAML in which recipes and cards are written, and says on which line what stands.

A file is a list of `name: value`; a value is a number, true, false, a list of them in brackets, a text, or, with
nothing after the colon, the indented lines that follow, each again `name: value`. What this reads means the same to any
reader of YAML.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Entry:
    """What stands under a name: a value, or entries of its own."""

    line: int
    value: object = None
    entries: "dict[str, Entry]" = field(default_factory=dict)


def read_yaml(path: Path) -> dict[str, Entry]:
    """The entries of a file by name. Raises ValueError with file and line where one cannot be read."""
    top: dict[str, Entry] = {}
    inner: dict[str, Entry] | None = None
    for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        where = f"{path}:{number}"
        content = _without_comment(text)
        if not content:
            continue
        name, colon, rest = content.strip().partition(":")
        if not colon or (rest and not rest.startswith(" ")):
            raise ValueError(f"{where}: expected 'name: value', found {content.strip()!r}")
        indented = content.startswith(" ")
        if indented and inner is None:
            raise ValueError(f"{where}: {name} is indented, but the line before it holds a value already")
        block = inner if indented and inner is not None else top
        if name in block:
            raise ValueError(f"{where}: {name} is there twice, first on line {block[name].line}")
        block[name] = Entry(number, _value(rest.strip(), where))
        if not indented:
            inner = block[name].entries if not rest.strip() else None
    return top


def _without_comment(text: str) -> str:
    """A line up to a # that begins it or follows a space, if it is not in quotes."""
    if text.lstrip().startswith("#"):
        return ""
    quoted = '"' in text.partition(" #")[0]
    return text.rstrip() if quoted else text.partition(" #")[0].rstrip()


def _value(text: str, where: str) -> object:
    """A number, truth value or list as in JSON; anything else is a text."""
    if not text:
        return None
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        if text[0] in "[{\"'&*!|>%@`" or ": " in text:
            raise ValueError(f"{where}: {text!r} is no number, list or plain text") from None
        return text
