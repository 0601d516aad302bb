"""The command line: `python -m benchmarks.scripted`."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from benchmarks.report import machine
from benchmarks.scripted.compare import HARD, RECORDED, RUNS, Compared, compare
from benchmarks.scripted.pictures import write_picture
from benchmarks.scripted.record import record
from benchmarks.scripted.tasks import TASKS
from manyhands.files import write_text

DESCRIPTION = """\
Scripted tasks of robosuite and metaworld: what MuJoCo's step sees is recorded in their own environments, and replayed
in MuJoCo and in manyhands from the same start. Prints the outcome of each, and writes build/scripted.json.
"""
EPILOG = """\
Examples:
  python -m benchmarks.scripted --only door              tasks whose names hold this
  MUJOCO_GL=egl python -m benchmarks.scripted --pictures docs/images/scripted

The first run installs both packages in environments of their own below --environments, and records, which takes
minutes. Ends with status 1 if an outcome is neither the recorded one nor MuJoCo's with hard limits and contacts, each
within 10 %.
docs/scripted_tasks.md explains the columns.
"""


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.scripted",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--only", action="append", default=[], metavar="TEXT", help="tasks whose names hold it")
    parser.add_argument(
        "--folder", type=Path, default=Path("build/scripted"), help="of recordings (default: %(default)s)"
    )
    parser.add_argument(
        "--environments", type=Path, default=Path("build/realfiles"), help="of the packages (default: %(default)s)"
    )
    parser.add_argument("--pictures", type=Path, metavar="FOLDER", help="write a picture of each pair there")
    parser.add_argument("--output", type=Path, default=Path("build/scripted.json"), help="default: %(default)s")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Records what is missing, replays, reports; returns the exit status."""
    options = parse(arguments)
    console = Console(width=None if sys.stdout.isatty() else 160)
    tasks = [task for task in TASKS if not options.only or any(text in task.title for text in options.only)]
    record(tasks, options.folder, options.environments)
    found: list[Compared] = []
    for task in tasks:
        compared = compare(task, options.folder / task.package / task.name)
        for run, why in compared.failed.items():
            console.print(f"{task.title}: {run}: {why}", highlight=False, markup=False)
        if options.pictures:
            write_picture(compared, options.pictures / f"{task.package}_{task.name}.webp")
        found.append(compared)
    console.print(table_of(found))
    figures = machine() | {"tasks": [compared.figures() for compared in found]}
    write_text(options.output, json.dumps(figures, indent=1) + "\n")
    console.print(f"Written: {options.output}")
    return int(any(compared.verdict == "differs" for compared in found))


def table_of(found: Sequence[Compared]) -> Table:
    """A line a task."""
    table = Table("task", "outcome", *RUNS, "difference", "from hard", "verdict")
    for compared in found:
        outcomes = [compared.outcome(run) for run in RUNS]
        table.add_row(
            compared.task.title,
            f"{compared.task.outcome} [{compared.task.unit}]",
            *("failed" if outcome is None else f"{outcome:.4f}" for outcome in outcomes),
            f"{compared.difference(RECORDED):+.1%}",
            f"{compared.difference(HARD):+.1%}",
            compared.verdict,
        )
    return table


if __name__ == "__main__":
    sys.exit(main())
