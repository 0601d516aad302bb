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
    """The entries of a file by name. Raises ValueError with file and line where one cannot be read, OSError where the
    file cannot."""
    top: dict[str, Entry] = {}
    inner: dict[str, Entry] | None = None
    for number, text in enumerate(_lines(path), start=1):
        where = f"{path}:{number}"
        content = _without_comment(text)
        if not content:
            continue
        if "\t" in content[: len(content) - len(content.lstrip())]:
            raise ValueError(f"{where}: the line begins with a tab; YAML indents by spaces")
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


def _lines(path: Path) -> list[str]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: byte {error.start} is not UTF-8; expected a text file in UTF-8") from None
    if "\0" in text:
        raise ValueError(f"{path} is no text file")
    lines = text.splitlines()
    return ["", *lines[1:]] if lines[:1] == ["---"] else lines  # where a document begins


def _without_comment(text: str) -> str:
    """A line up to a # that begins it or follows a space, if it is not in quotes."""
    quote = ""
    for at, mark in enumerate(text):
        before = text[at - 1] if at > 0 else " "
        if quote:
            quote = "" if mark == quote and before != "\\" else quote
        elif mark in "\"'" and before in " [,":
            quote = mark
        elif mark == "#" and before in " \t":
            return text[:at].rstrip()
    return text.rstrip()


def _value(text: str, where: str) -> object:
    """A number, truth value or list as in JSON, or a text in single quotes; anything else is a plain text."""
    if not text:
        return None
    if len(text) > 1 and text[0] == text[-1] == "'" and "'" not in text[1:-1].replace("''", ""):
        return text[1:-1].replace("''", "'")
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        if text[0] in "[{\"'&*!|>%@`" or ": " in text:
            raise ValueError(f"{where}: {text!r} is no number, list or plain text") from None
        return text
