"""One program in a process of its own: `python -m benchmarks.bullet.launcher SIDE SECONDS REPORT KIND NAME PATH ...`.

Ends the program when its time is over, and writes what came of it as JSON.
"""

import faulthandler
import json
import os
import random
import runpy
import signal
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import manyhands
from benchmarks.bullet import environment
from benchmarks.bullet.headless import Headless
from benchmarks.bullet.programs import ENVIRONMENT

SIDES = {"bullet": ("gym",), "here": ("pybullet", "pybullet_data", "pybullet_utils", "gym")}
"""The names that stand for our modules; the old gym, which both need, is ours on both."""
TICKS = 16
PATIENCE = 3  # seconds on the clock for one of the processor, where a program waits for others


class Watch:
    """Follows a program, and tells how it ended."""

    def __init__(self, headless: Headless, seconds: float, report: Path) -> None:
        self.headless, self.seconds, self.report = headless, seconds, report
        self.started = time.monotonic()
        self.samples: list[tuple[float, int]] = []
        self.owner = os.getpid()

    def start(self) -> None:
        """Looks at the program from time to time, by the processor's clock and by the wall's."""
        for signals, timer, factor in (
            (signal.SIGPROF, signal.ITIMER_PROF, 1),
            (signal.SIGALRM, signal.ITIMER_REAL, PATIENCE),
        ):
            signal.signal(signals, self._tick)
            signal.setitimer(timer, self.seconds * factor / TICKS, self.seconds * factor / TICKS)

    def _tick(self, _signal: int, _frame: FrameType | None) -> None:
        cpu, wall = time.process_time(), time.monotonic() - self.started
        share = max(cpu / self.seconds, wall / self.seconds / PATIENCE)
        calls = self.headless.totals[0]
        if share < 1:
            self.samples.append((share, calls))
            return
        before = [count for at, count in self.samples if at <= 0.75]
        self.end("time", alive=calls != (before[-1] if before else 0))

    def end(self, how: str, **more: Any) -> None:
        """Writes the report, and leaves at once."""
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        sys.stdout.flush()
        if os.getpid() != self.owner:
            os._exit(0)
        headless = self.headless
        last = {} if how == "crash" else headless.look()
        told = {
            "ended": how,
            "calls": headless.totals[0],
            "steps": headless.totals[1],
            "called": dict(headless.called),
            "looks": headless.looks,
            "last": last,
            "cpu_seconds": round(time.process_time(), 2),
        }
        self.report.write_text(json.dumps(told | more))
        sys.stderr.flush()
        os._exit(0)


def run(kind: str, name: str, path: str) -> dict[str, Any]:
    """Runs a program as Python does; what an environment has to tell."""
    if kind == ENVIRONMENT:
        return environment.drive(name)
    sys.path[0] = str(Path(path).parent)
    runpy.run_path(path, run_name="__main__")
    return {}


def follow(watch: Watch, work: Callable[[], dict[str, Any]]) -> None:
    """Runs and tells how it ended."""
    try:
        more = work()
    except SystemExit as left:
        if left.code in (None, 0):
            watch.end("exit")
        watch.end("error", error="SystemExit", message=f"leaves with {left.code!r}", where="")
    except BaseException as error:
        traceback.print_exc()
        frames = traceback.extract_tb(error.__traceback__)
        where = f"{Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else ""
        watch.end("error", error=type(error).__name__, message=str(error), where=where)
    else:
        watch.end("exit", **more)


def main(arguments: list[str]) -> None:
    """Sets up a side, and runs."""
    side, seconds, report, kind, name, path, *rest = arguments
    faulthandler.enable()
    random.seed(0)
    np.random.seed(0)  # noqa: NPY002  what the programs draw from
    manyhands.install_as(*SIDES[side])
    import pybullet

    headless = Headless(pybullet)
    headless.install()
    sys.argv = [path, *rest]
    watch = Watch(headless, float(seconds), Path(report))
    watch.start()
    follow(watch, lambda: run(kind, name, path))


if __name__ == "__main__":
    main(sys.argv[1:])
