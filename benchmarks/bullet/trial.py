"""Programs in processes of their own, on both sides, and what came of each."""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.bullet.programs import Program

BULLET, HERE = "bullet", "here"
SIDES = (BULLET, HERE)
LIMIT = 10.0  # of the time on the clock to the time that a program gets of the processor, and
START_UP = 60.0  # seconds on the clock for imports
SHOWN = 400  # characters of what a program printed last, kept for who looks for a reason


@dataclass
class Outcome:
    """What came of a program on one side. `runs`: it ended well, or was at work when its time was over. `why` it does
    not; `told`: what the launcher reports; `tail`: what the program printed last."""

    runs: bool
    why: str = ""
    steps: int = 0
    calls: int = 0
    told: dict[str, Any] = field(default_factory=dict)
    tail: str = ""


Result = dict[str, Outcome]


def run_all(
    programs: Sequence[Program],
    seconds: float,
    jobs: int,
    surroundings: Mapping[str, str],
) -> Iterator[tuple[Program, Result]]:
    """Runs each program on each side, `jobs` at a time; gives the results in the programs' order."""

    def both(program: Program) -> Result:
        return {side: run(program, side, seconds, surroundings) for side in SIDES}

    with ThreadPoolExecutor(jobs) as pool:
        yield from zip(programs, pool.map(both, programs), strict=True)


def run(program: Program, side: str, seconds: float, surroundings: Mapping[str, str]) -> Outcome:
    """Runs one in an empty folder."""
    with tempfile.TemporaryDirectory(prefix="bullet_") as folder:
        report = Path(folder) / "report.json"
        printed = Path(folder) / "printed.txt"
        inside = Path(folder) / "work"
        inside.mkdir()
        named = [side, str(seconds), str(report), program.kind, program.name, str(program.path)]
        command = [sys.executable, "-m", "benchmarks.bullet.launcher", *named, *program.arguments]
        with printed.open("wb") as output:
            process = subprocess.Popen(
                command, cwd=inside, env=surroundings, stdin=subprocess.DEVNULL, stdout=output,
                stderr=subprocess.STDOUT, start_new_session=True,
            )  # fmt: skip
        try:
            status = process.wait(START_UP + LIMIT * seconds)
        except subprocess.TimeoutExpired:
            status = None
        finally:
            end_all(process)
        tail = printed.read_text(errors="replace")[-SHOWN:]
        told = json.loads(report.read_text()) if report.is_file() else {}
        return judge(status, told, tail)


def end_all(process: subprocess.Popen[bytes]) -> None:
    """Ends a program and the processes that it started, which are a session."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def judge(status: int | None, told: dict[str, Any], tail: str) -> Outcome:
    """What a program's end means."""
    steps, calls = told.get("steps", 0), told.get("calls", 0)
    if status is None:
        return Outcome(False, "is in one call all of its time", told=told, tail=tail)
    if not told:
        return Outcome(False, f"crashes: {name_of(status)}", tail=tail)
    why = ""
    if told["ended"] == "error":
        why = reason(told)
    elif told["ended"] == "time" and not told["alive"]:
        why = "hangs: no call in the last quarter of its time"
    elif told.get("finite") is False or not all(look["finite"] for look in told["looks"].values()):
        why = "gives numbers that are not finite"
    return Outcome(not why, why, steps, calls, told, tail)


def name_of(status: int) -> str:
    """How a process ended that told nothing."""
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def reason(told: dict[str, Any]) -> str:
    """The error, in one line."""
    message = re.sub(r"/\S*/site-packages/", "", " ".join(str(told["message"]).split()))
    where = f" ({told['where']})" if told["where"] else ""
    return f"{told['error']}: {message}"[:300] + where
