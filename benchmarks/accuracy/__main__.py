"""The command line: `python -m benchmarks.accuracy`."""

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.accuracy import rows as rowing
from benchmarks.accuracy.case import ENGINES, LANES, OURS, Case
from benchmarks.accuracy.cases import CASES
from benchmarks.accuracy.document import write_document
from benchmarks.accuracy.plots import draw
from benchmarks.accuracy.rows import Row
from benchmarks.accuracy.runner import Task, run_all
from benchmarks.accuracy.table import show
from benchmarks.accuracy.verdicts import word_of_case
from benchmarks.report import machine

DESCRIPTION = """\
How right the physics is. Runs published and own cases of contact, loops and free motion in manyhands (double, and float
lanes), MuJoCo and PyBullet, each from one description of the scene; compares with closed forms and with what was
published; prints a table, draws speed-accuracy curves, and writes every row as JSON.
"""
EPILOG = """\
Examples:
  python -m benchmarks.accuracy --quick                        a minute: one setting a case
  python -m benchmarks.accuracy --case rolling --case pinch    some cases, all their time steps, every row printed
  python -m benchmarks.accuracy --engine manyhands --fresh     ours again, though nothing has changed
  python -m benchmarks.accuracy --list                         the cases

How to read it: an error counts at the real-time factor beside it (RTF: simulated seconds per second of one processor
core, reading and looking not counted). Rows are written as they finish: a run that is interrupted goes on where it was,
and rows whose engine and case have not changed are kept. Ends with status 1 if a case of manyhands fails.
docs/accuracy.md explains every case.
"""
FULL_BUDGET, QUICK_BUDGET = 20.0, 4.0  # processor seconds of a run


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.accuracy",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="one setting a case, about a minute")
    parser.add_argument(
        "--case", action="append", choices=list(CASES), metavar="NAME", help="only this; may be repeated"
    )
    parser.add_argument("--engine", action="append", choices=ENGINES, help="only this; may be repeated")
    parser.add_argument("--fresh", action="store_true", help="run again what has been run")
    parser.add_argument("--all", action="store_true", help="print every row, not only verdicts (as with --case)")
    parser.add_argument("--list", action="store_true", help="name the cases and end")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="runs at a time (default: %(default)s)")
    parser.add_argument("--budget", type=float, help="processor seconds that a run may take")
    parser.add_argument(
        "--output", type=Path, default=Path("build/accuracy.json"), help="where the rows go (default: %(default)s)"
    )
    parser.add_argument("--document", action="store_true", help="write the tables into docs/accuracy.md, too")
    return parser.parse_args(arguments)


def planned(case: Case, engine: str, quick: bool) -> list[Task]:
    """The runs of a case."""
    return [Task(case.name, settings) for settings in (case.quick if quick else case.plan)(engine)]


def with_budget(task: Task, seconds: float) -> Task:
    """The same, with its time."""
    return Task(task.case, replace(task.settings, budget=seconds))


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs what is asked for and not yet there; returns the exit status."""
    options = parse(arguments)
    console = Console(width=None if sys.stdout.isatty() else 200)
    if options.list:
        for case in CASES.values():
            console.print(f"{case.name:26} {case.title}", highlight=False)
        return 0
    cases = [CASES[name] for name in options.case or CASES]
    budget = options.budget or (QUICK_BUDGET if options.quick else FULL_BUDGET)
    tasks = [
        with_budget(task, budget)
        for case in cases
        for engine in options.engine or ENGINES
        for task in planned(case, engine, options.quick)
    ]
    about = machine() | {"quick": options.quick}
    try:
        rows = run(tasks, options, about, console)
    except KeyboardInterrupt:
        console.print(f"Interrupted. {options.output} keeps what is done; the same command goes on from there.")
        return 130
    mine = wanted(rows, tasks)
    show(console, cases, mine, options.all or bool(options.case))
    pictures = draw(options.output.with_suffix(""), cases, mine)
    console.print(
        f"Written: {options.output}" + (f", {len(pictures)} pictures in {pictures[0].parent}" if pictures else "")
    )
    if options.document:
        write_document(Path("docs/accuracy.md"), cases, mine, about)
        console.print("Written: docs/accuracy.md")
    failed = [case.name for case in cases if word_of_case(case, mine, OURS) == "fail"]
    unlike = [
        case.name
        for case in cases
        if word_of_case(case, mine, LANES) not in (word_of_case(case, mine, OURS), "not run")
    ]
    if unlike:
        console.print(f"Float lanes reach another verdict than double in: {', '.join(unlike)}")
    if failed:
        console.print(f"manyhands fails: {', '.join(failed)}", style="red")
    return 1 if failed else 0


def wanted(rows: Sequence[Row], tasks: Sequence[Task]) -> list[Row]:
    """Of these runs, in their order."""
    order = {rowing.run_of(CASES[task.case], task.settings): k for k, task in enumerate(tasks)}
    return sorted((row for row in rows if row.run in order), key=lambda row: order[row.run])


def run(tasks: Sequence[Task], options: argparse.Namespace, about: dict[str, object], console: Console) -> list[Row]:
    """All rows: those that were there, and those of the tasks that had to run, written as they finish."""
    rows = rowing.read(options.output)
    todo = [task for task in tasks if options.fresh or not rowing.kept(rows, CASES[task.case], task.settings)]
    console.print(
        f"{about['cpu']}, {about['cores']} cores, load {about['load']}. "
        f"{len(todo)} runs, {len(tasks) - len(todo)} kept.",
        highlight=False,
    )
    columns = [TextColumn("{task.description:60.60}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()]
    with Progress(*columns, TimeRemainingColumn(), console=console) as progress:
        bar = progress.add_task("", total=len(todo))

        def finished(task: Task, new: list[Row]) -> None:
            nonlocal rows
            key = rowing.run_of(CASES[task.case], task.settings)
            rows = [row for row in rows if row.run != key] + new
            rowing.write(options.output, rows, about)
            progress.advance(bar)

        def started(tasks: Sequence[Task]) -> None:
            progress.update(bar, description=" | ".join(task.title for task in tasks))

        run_all(todo, max(1, options.jobs), finished, started)
    return rows


if __name__ == "__main__":
    sys.exit(main())
