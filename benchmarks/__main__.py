"""The command line: `python -m benchmarks`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.contact import run_contact
from benchmarks.picture_peers import run_picture_peers
from benchmarks.pinocchio_peer import run_pinocchio
from benchmarks.programs import run_programs
from benchmarks.report import contact_stages, machine, stage_tree, table, write_json
from benchmarks.rows import Row
from benchmarks.targets import compare_with_peers, judge
from benchmarks.tasks import TASKS, run_tasks

PARTS = ("programs", "pinocchio", "pictures", "tasks", "contact")
DESCRIPTION = """\
Measures manyhands and, in the same run and in turns, the programs people use today: panda-gym, Pinocchio,
MuJoCo and PyBullet.
Prints a table and the profiles of a Reach step and of steps in contact, and writes a file of JSON with the same rows.
"""
EPILOG = """\
How to read it: values are medians over rounds, ± is the scatter between rounds (over 10 % is marked "noisy": something
else ran on the machine). Figures of the C++ programs count the thread's own processor time, rates of environments the
clock on the wall. A result that was not what it must be, to the bit, is refused and ends the run with status 1.
A target that is missed is "short" and ends it with status 0. docs/performance.md explains every row.
"""


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="few and short rounds: shows that it runs, not how fast")
    parser.add_argument(
        "--programs",
        type=Path,
        default=Path("build/release/benchmarks"),
        help="folder of the C++ benchmarks (default: %(default)s)",
    )
    parser.add_argument(
        "--output", type=Path, default=Path("build/bench.json"), help="where the rows go (default: %(default)s)"
    )
    parser.add_argument("--only", choices=PARTS, help="measure this part alone (default: all)")
    return parser.parse_args(arguments)


def run_part(part: str, options: argparse.Namespace, rounds: int, seconds: float, before: list[Row]) -> list[Row]:
    """The rows of a part; `before` holds those of the parts before it."""
    if part == "programs":
        return run_programs(options.programs, options.quick)
    if part == "pinocchio":
        return run_pinocchio(rounds, seconds / 4)
    if part == "pictures":
        return run_picture_peers(rounds, seconds)
    if part == "tasks":
        return run_tasks(TASKS[:2] if options.quick else TASKS, rounds, seconds / 2)
    return run_contact(options.programs, rounds, seconds, before)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs everything; returns the exit status."""
    options = parse(arguments)
    rounds, seconds = (2, 0.02) if options.quick else (9, 0.4)
    about = machine() | {"quick": options.quick}
    print(f"{about['cpu']}, {about['cores']} cores, {about['compiler']}, load {about['load']}", flush=True)
    if about["load"] > 0.5:
        print("Something else is running: figures, above all those of two threads, will fall short.", flush=True)
    rows: list[Row] = []
    for part in PARTS:
        if options.only in (None, part):
            rows += run_part(part, options, rounds, seconds, rows)
    compare_with_peers(rows)
    judge(rows)
    for text in filter(None, (table(rows), stage_tree(rows), contact_stages(rows))):
        print(f"\n{text}")
    write_json(options.output, rows, about)
    print(f"\nWritten: {options.output}")
    wrong = [row for row in rows if row.wrong]
    for row in wrong:
        print(f"{row.benchmark} ({row.number_type}): {row.note}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
