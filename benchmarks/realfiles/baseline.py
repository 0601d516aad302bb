"""Which files are known to fail: a run ends well if no other does."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.realfiles.results import COLUMNS, FAIL, PASS, Result, verdicts
from manyhands.files import write_text

PATH = Path(__file__).with_name("baseline.json")


@dataclass
class Beside:
    """Files, by column: what has become worse than the baseline, and what better."""

    worse: dict[str, list[str]] = field(default_factory=dict)
    better: dict[str, list[str]] = field(default_factory=dict)


def read(path: Path = PATH) -> dict[str, list[str]]:
    """Known failures by column."""
    return json.loads(path.read_text()) if path.is_file() else {column: [] for column in COLUMNS}


def beside(results: Sequence[Result], known: dict[str, list[str]]) -> Beside:
    """A run of any part of the files beside what is known."""
    found = Beside()
    for result in results:
        for column, word in verdicts(result).items():
            is_known = result["file"] in known.get(column, ())
            if word == FAIL and not is_known:
                found.worse.setdefault(column, []).append(result["file"])
            elif word == PASS and is_known:
                found.better.setdefault(column, []).append(result["file"])
    return found


def write(results: Sequence[Result], known: dict[str, list[str]], path: Path = PATH) -> None:
    """What fails now; of files that were not run, what was known."""
    ran = {result["file"] for result in results}
    failing = {column: {file for file in known.get(column, ()) if file not in ran} for column in COLUMNS}
    for result in results:
        for column, word in verdicts(result).items():
            if word == FAIL:
                failing[column].add(result["file"])
    write_text(path, json.dumps({column: sorted(files) for column, files in failing.items()}, indent=1) + "\n")
