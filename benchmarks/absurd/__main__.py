"""The command line: `python -m benchmarks.absurd`."""

import argparse
import hashlib
import json
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

import manyhands as mh
from benchmarks import children, lines
from benchmarks.absurd import summary
from benchmarks.absurd.examine import Task, examine
from benchmarks.absurd.families import FAMILIES, family_of, setting_of
from benchmarks.absurd.run import FAILED, Outcome, run
from benchmarks.lines import Result
from benchmarks.report import machine
from manyhands.files import write_text

DESCRIPTION = """\
Random scenes without reason: overlap, singular loops, mass ratios to 1e9, speeds to 1e6, gains to 1e12, welds beyond
reach. Each is stepped and looked at from outside: its energy stays bounded, or a step raises an error that says what,
when and why. A crash, a hang, a state that is not finite or energy from nowhere is a failure.
"""
EPILOG = """\
Examples:
  python -m benchmarks.absurd --scenes 500 --family loops     some of one family
  python -m benchmarks.absurd --scene 1144                     one scene, what it does, and its MJCF

Results are written as they come; the same command goes on where it was interrupted. Ends with status 1 if one fails.
docs/absurd.md says how to read the table.
"""
PRELOAD = ("benchmarks.absurd.examine",)
TOGETHER = 20  # scenes in one process


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """The command line's options."""
    parser = argparse.ArgumentParser(
        "python -m benchmarks.absurd",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--scenes", type=int, default=10000, metavar="N", help="default: %(default)s")
    parser.add_argument("--seed", type=int, default=0, help="of all scenes (default: %(default)s)")
    parser.add_argument("--scene", type=int, metavar="N", help="this one alone, with its MJCF and what it does")
    parser.add_argument("--family", choices=list(FAMILIES), help="only these")
    parser.add_argument(
        "--lanes", type=int, default=4, metavar="K", help="every K-th in lanes, too (default: 4; 0: none)"
    )
    parser.add_argument(
        "--seconds", type=float, default=float("inf"), help="on the clock, until no scene begins any more"
    )
    parser.add_argument("--limit", type=float, default=60.0, help="processor seconds of a scene (default: 60)")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="processes at a time (default: %(default)s)"
    )
    parser.add_argument("--fresh", action="store_true", help="run again what has been run")
    parser.add_argument("--output", type=Path, default=Path("build/absurd.json"), help="default: %(default)s")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs what is asked for and not yet there; returns the exit status."""
    options = parse(arguments)
    console = Console(width=None if sys.stdout.isatty() else 200)
    if options.scene is not None:
        return one_scene(options, console)
    path = options.output.with_suffix(".jsonl")
    try:
        found = run_all(options, path, console)
    except KeyboardInterrupt:
        console.print(f"Interrupted. {path} keeps what is done; the same command goes on from there.")
        return 130
    summary.show(console, found)
    write_text(options.output, json.dumps(machine() | summary.figures(found), indent=1) + "\n")
    console.print(f"Written: {options.output}, {path}")
    return 1 if any(result["outcome"] == FAILED for result in found) else 0


def one_scene(options: argparse.Namespace, console: Console) -> int:
    """The scene and its outcome, in this process."""
    console.print(setting_of(options.seed, options.scene).text().replace("><", ">\n<"), highlight=False, markup=False)
    outcome = run(options.seed, options.scene, in_lanes=options.lanes > 0)
    for name, value in outcome.words().items():
        console.print(f"{name}: {value}", highlight=False, markup=False)
    return 1 if outcome.outcome == FAILED else 0


def key_of(seed: int) -> str:
    """Of what results depend on: the engine, the scenes and the checks."""
    digest = hashlib.sha256()
    for file in [*sorted(Path(mh.__file__).parent.glob("*.so")), *sorted(Path(__file__).parent.glob("*.py"))]:
        digest.update(file.read_bytes())
    return f"{digest.hexdigest()[:16]}, seed {seed}"


def run_all(options: argparse.Namespace, path: Path, console: Console) -> list[Result]:
    """The outcomes of all scenes: those that were there, and those that had to run."""
    key, end = key_of(options.seed), time.monotonic() + options.seconds
    path.parent.mkdir(parents=True, exist_ok=True)
    done = {} if options.fresh else lines.read(path, "number", key)
    lines.write(path, done.values())
    wanted = [n for n in range(options.scenes) if options.family in (None, family_of(n))]
    console.print(f"{sum(n not in done for n in wanted)} scenes to run.", highlight=False)

    def finished(ended: children.Ended[Task]) -> None:
        for result in outcomes(ended):
            done[result["number"]] = result | {"key": key}
            lines.append(path, done[result["number"]])

    while time.monotonic() < end:
        todo = [n for n in wanted if n not in done][: 4 * TOGETHER * max(1, options.jobs)]
        if not todo:
            break
        groups = [tuple(todo[k : k + TOGETHER]) for k in range(0, len(todo), TOGETHER)]
        tasks = [Task(options.seed, numbers, options.limit, options.lanes) for numbers in groups]
        children.run_all(tasks, examine, patience, max(1, options.jobs), finished, lambda _: None, PRELOAD)
    return [done[n] for n in wanted if n in done]


def outcomes(ended: children.Ended[Task]) -> list[Result]:
    """What a child has told; the scene in which it died has failed, and those after it are still to run."""
    found = [said for said in ended.said if "outcome" in said]
    why = lines.ending(ended.status)
    if why:
        number = [said["began"] for said in ended.said if "began" in said][-1]
        found.append(Outcome(number, family_of(number), FAILED, why).words())
    return found


def patience(task: Task) -> float:
    """Seconds on the clock: the machine may be busy."""
    return 60 + 5 * task.limit * len(task.numbers)


if __name__ == "__main__":
    sys.exit(main())
