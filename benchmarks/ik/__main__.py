"""Inverse kinematics of random reachable poses: `python -m benchmarks.ik`.

Poses are those of random configurations within the limits. One is solved if the configuration that comes back is
within the limits and leads to it to 1e-6 m and rad, by forward kinematics in double precision. Rates are solutions a
second of processor time, the best of some runs. Programs that are not installed are passed over:
`pip install manyhands[peers]`.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.ik.arms import arms, reachable
from benchmarks.ik.measure import Figures, measure
from benchmarks.ik.peers import PROGRAMS, Beside, beside
from benchmarks.report import machine
from manyhands.files import write_text

_BESIDE = "panda"


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.ik", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    names = [arm.name for arm in arms()]
    parser.add_argument("--arms", nargs="*", default=names, choices=names)
    parser.add_argument("--poses", type=int, default=10_000, help="of each arm (default: %(default)s)")
    parser.add_argument("--singles", type=int, default=1000, help="that are solved one by one (default: %(default)s)")
    parser.add_argument("--beside", type=int, default=1000, help=f"poses of the {_BESIDE} for other programs; 0: none")
    parser.add_argument("--repeats", type=int, default=5, help="of all poses at once; the best counts")
    parser.add_argument("--out", type=Path, default=Path("build/ik.json"), help="where the figures go")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> None:
    options = parse(arguments)
    chosen = [arm for arm in arms() if arm.name in options.arms]
    console = Console()
    about = machine()
    console.print(f"{about['cpu']}, load {about['load']}", highlight=False)
    own: list[Figures] = []
    others: list[Beside | str] = []
    columns = [TextColumn("{task.description:30}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn()]
    with Progress(*columns, console=console) as progress:
        bar = progress.add_task("", total=len(chosen) * (options.repeats + 1))
        for arm in chosen:
            progress.update(bar, description=arm.name)
            poses = reachable(arm, options.poses)
            own.append(measure(arm, poses, options.singles, options.repeats, lambda: progress.advance(bar)))
        if options.beside:
            arm = next(arm for arm in arms() if arm.name == _BESIDE)
            bar = progress.add_task("other programs", total=options.beside * len(PROGRAMS))
            others += beside(arm, reachable(arm, options.beside), lambda: progress.advance(bar))
    console.print(_table(own), highlight=False, markup=False)
    if others:
        console.print(_beside_table(others), highlight=False, markup=False)
    figures = {"arms": [asdict(f) for f in own], "beside": [b if isinstance(b, str) else asdict(b) for b in others]}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    write_text(options.out, json.dumps(about | figures, indent=1) + "\n")
    console.print(f"Written: {options.out}", highlight=False)


def _table(rows: Sequence[Figures]) -> str:
    lines = [
        "| arm | solved | of the rest, by more restarts | solutions/s | one call, us | from nearby | without Python |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for f in rows:
        later = sum(failure["with_more_restarts"] for failure in f.failures)
        lines.append(
            f"| {f.arm} | {f.solved / f.poses:.2%} | {later} of {len(f.failures)} | {f.rate:,.0f} "
            f"| {f.single * 1e6:.1f} | {f.single_nearby * 1e6:.1f} | {f.core_nearby * 1e6:.1f} |"
        )
    return "\n".join(lines)


def _beside_table(rows: Sequence[Beside | str]) -> str:
    lines = [f"| {_BESIDE} by | solved | solutions/s | one pose, us |", "| --- | --- | --- | --- |"]
    lines += [
        f"| {b.program} | {b.solved / b.poses:.1%} | {b.rate:,.0f} | {b.single * 1e6:,.0f} |"
        for b in rows
        if isinstance(b, Beside)
    ]
    return "\n".join([*lines, *(b for b in rows if isinstance(b, str))])


if __name__ == "__main__":
    main()
