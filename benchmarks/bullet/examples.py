"""`python -m benchmarks.bullet examples`: the programs and environments of the wheel, here and on PyBullet."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from benchmarks.bullet import compare, extras, programs, table, trial
from benchmarks.report import machine
from manyhands.files import write_text

DESCRIPTION = """\
The example scripts and gym environments of PyBullet's wheel, headless, on PyBullet and on manyhands.pybullet: which
run, and why the others do not. Writes build/bullet_examples.json.
"""
EPILOG = """\
Examples:
  python -m benchmarks.bullet examples --only inverse_kinematics --seconds 2
  python -m benchmarks.bullet examples --table docs/pybullet_examples.md     all: half an hour

The first run installs packages that scripts want below --folder. Ends with status 1 if less than 90 % of what runs on
PyBullet runs here. docs/pybullet_examples.md says what counts as running.
"""
SHARE = 0.9
ROOT = Path(__file__).resolve().parents[2]


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.bullet examples",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--only", action="append", default=[], metavar="TEXT", help="programs whose names hold it")
    parser.add_argument("--seconds", type=float, default=8.0, help="of the processor for each run (default: 8)")
    parser.add_argument("--jobs", type=int, default=1, help="programs at a time (default: 1)")
    parser.add_argument("--list", action="store_true", help="name the programs and end")
    parser.add_argument("--table", type=Path, metavar="FILE", help="write the page of the documentation there")
    parser.add_argument(
        "--folder", type=Path, default=Path("build/bullet"), help="of what is installed (default: %(default)s)"
    )
    parser.add_argument("--output", type=Path, default=Path("build/bullet_examples.json"), help="default: %(default)s")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs what is asked for, and reports; returns the exit status."""
    options = parse(arguments)
    console = Console(width=None if sys.stdout.isatty() else 200, highlight=False, markup=False)
    wheel = programs.wheel()
    chosen = programs.matching([*programs.scripts(wheel), *programs.environments(wheel)], options.only)
    if options.list:
        for program in chosen:
            console.print(program.name)
        return 0
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    extras.install(folder)
    surroundings = extras.surroundings(folder, ROOT)
    rows: list[compare.Row] = []
    records = []
    for program, result in trial.run_all(chosen, options.seconds, options.jobs, surroundings):
        row = compare.row_of(program, result)
        rows.append(row)
        records.append(compare.record(row, result))
        console.print(f"{row.name}: {row.bullet} on Bullet, {row.here} here{'; ' if row.why else ''}{row.why}")
    counted, passed = sum(row.counts for row in rows), sum(row.passes for row in rows)
    console.print(f"{passed} of {counted} that run on PyBullet run here; {len(rows)} in all.")
    write_text(options.output, json.dumps(machine() | {"programs": records}, indent=1) + "\n")
    console.print(f"Written: {options.output}")
    if options.table:
        write_text(options.table, table.page(rows, options.seconds))
        console.print(f"Written: {options.table}")
    return int(passed < SHARE * counted)
