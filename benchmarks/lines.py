"""Results as lines of JSON, written as they come, so that a run that is interrupted goes on where it was."""

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from manyhands.files import write_text

Result = dict[str, Any]


def read(path: Path, by: str, key: str | None = None) -> dict[Any, Result]:
    """Results by what their field `by` says; a line that was cut short is passed over, and so are those of another
    key."""
    found: dict[Any, Result] = {}
    if not path.is_file():
        return found
    for line in path.read_text().splitlines():
        try:
            result = json.loads(line)
        except json.JSONDecodeError:
            continue
        if key is None or result["key"] == key:
            found[result[by]] = result
    return found


def append(path: Path, result: Result) -> None:
    """One line, written whole."""
    line = (json.dumps(result) + "\n").encode()
    descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    try:
        os.write(descriptor, line)
    finally:
        os.close(descriptor)


def write(path: Path, results: Iterable[Result]) -> None:
    """The file anew, whole or not at all."""
    write_text(path, "".join(json.dumps(result) + "\n" for result in results))


def ending(status: int | None) -> str:
    """How a child process ended; empty if all went well."""
    if status is None:
        return "hangs"
    if status == -24:
        return "out of processor time"
    return "" if status == 0 else f"crashes with status {status}"
