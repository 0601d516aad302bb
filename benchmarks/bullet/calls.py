"""`python -m benchmarks.bullet calls` writes docs/pybullet_coverage.md: what the tests beside PyBullet compare."""

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.bullet.differences import DIFFERENCES, NOT_COMPARED

if TYPE_CHECKING:
    from benchmarks.bullet.beside import Compared

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests/oracles/pybullet_module"
TABLE = ROOT / "docs/pybullet_coverage.md"
HEAD = """\
# PyBullet, function by function

Real PyBullet 3.2.7 and `manyhands.pybullet` get the same random calls, and what they return is compared: types,
lengths, texts and whole numbers exactly, floating point numbers within a tolerance, quaternions up to their sign. Wrong
input must raise the same kind of exception, and leave the world as it was to the bit.

The tests are `tests/oracles/pybullet_module`. They write this table, by `python -m benchmarks.bullet calls`, and fail
if it has less than they compare.

{count}

- *Options*: the optional arguments and the constants that were given; those that it needs, a function always gets.
- *Tolerance*: the largest of the tests; relative for numbers above 1. Empty: nothing differed at all.
- *Apart*: how far the results were apart at most, in one run.
- *Wrong input*: how many kinds of it were refused alike.

| function | options | calls | tolerance | apart | wrong input | what differs, and why |
| --- | --- | --- | --- | --- | --- | --- |
"""
REST = "## Not compared"
ROW = re.compile(r"^\| `(\w+)` \| (.*?) \|")


def rows_of(table: str) -> dict[str, set[str]]:
    """The functions that are compared by a table, and the options of each."""
    found = (ROW.match(line) for line in table.split(REST)[0].splitlines())
    return {row[1]: set(re.findall(r"`([^`]+)`", row[2])) for row in found if row}


def main(_: Sequence[str] = ()) -> int:
    """Runs the tests and writes the table; returns the exit status."""
    import pytest

    from benchmarks.bullet import beside

    tests = ["-q", "-p", "no:cacheprovider", "--no-table", "--ignore", str(TESTS / "test_table.py"), str(TESTS)]
    status = pytest.main(tests)
    if status != 0:
        print("The tests fail: the table stays as it is.", file=sys.stderr)
        return int(status)
    TABLE.write_text(table_of(beside.RECORD), encoding="utf-8")
    print(f"Written: {TABLE}")
    return 0


def table_of(record: "dict[str, Compared]") -> str:
    """The table of what was compared."""
    from benchmarks.bullet.beside import given

    lines, options, constants, refusals, calls = [], 0, 0, 0, 0
    for name in sorted(record, key=str.lower):
        one = record[name]
        shown = sorted(given(name, one), key=lambda option: (option.split("=")[0], option))
        options += sum("=" not in option for option in shown)
        constants += sum("=" in option for option in shown)
        refusals += len(one.refusals)
        calls += one.calls
        cells = [f"`{name}`", ", ".join(f"`{option}`" for option in shown), str(one.calls)]
        cells += [f"{one.tolerance:.0e}" if one.distance else "", f"{one.distance:.0e}" if one.distance else "0"]
        cells += [str(len(one.refusals) or ""), DIFFERENCES.get(name, "")]
        lines.append("| " + " | ".join(cells) + " |")
    count = (
        f"**{len(record)} functions, {options} optional arguments and {constants} constants: "
        f"{len(record) + options + constants} in all**, in {calls} calls, and {refusals} kinds of wrong input."
    )
    left = [f"| `{name}` | {why} |" for name, why in sorted(NOT_COMPARED.items(), key=lambda item: item[0].lower())]
    tail = f"\n\n{REST}\n\n| function | why |\n| --- | --- |\n" + "\n".join(left) + "\n"
    return HEAD.format(count=count) + "\n".join(lines) + tail
