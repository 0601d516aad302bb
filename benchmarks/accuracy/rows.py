"""Rows of build/accuracy.json: one for each figure of each run."""

import hashlib
import inspect
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.accuracy.case import LANES, Case, Measurement
from benchmarks.accuracy.engines.base import Settings, version
from manyhands.files import write_text

INCOMPLETE = "stopped"  # notes of runs that ran out of time begin so


@dataclass
class Row:
    """One figure. `error` is None where there is none; the note says why."""

    case: str
    engine: str
    variant: str
    number_type: str
    integrator: str
    time_step: float
    iterations: int | None
    metric: str
    error: float | None
    unit: str
    rtf: float | None
    bound: float | None
    bound_rtf: float | None
    verdict: str  # "pass", "fail", or "" where nothing is asked
    residuals: dict[str, float] = field(default_factory=dict)
    note: str = ""
    budget: float = 0.0  # [s] of the processor
    fingerprint: str = ""

    @property
    def run(self) -> tuple[Any, ...]:
        """What makes it the same run."""
        return (self.case, self.engine, self.variant, self.integrator, self.time_step, self.iterations)


def run_of(case: Case, settings: Settings) -> tuple[Any, ...]:
    """The same of settings not yet run."""
    s = settings
    return (case.name, s.engine, s.variant, s.integrator, s.time_step, s.iterations)


def fingerprint(case: Case, settings: Settings) -> str:
    """Of what was measured: the engine's version, the case's source, and the adapters."""
    digest = hashlib.sha256(version(settings.engine).encode())
    here = Path(__file__).parent
    run = getattr(case.run, "func", case.run)
    files = [Path(inspect.getfile(run)), *sorted((here / "engines").glob("*.py"))]
    for file in [*files, here / "scene.py", here / "mjcf.py", here / "measures.py"]:
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def row(case: Case, settings: Settings, **fields: Any) -> Row:
    """With what the settings say."""
    s = settings
    return Row(
        case=case.name,
        engine=s.engine,
        variant=s.variant,
        number_type="float lanes" if s.engine == LANES else "double",
        integrator=s.integrator,
        time_step=s.time_step,
        iterations=s.iterations,
        budget=s.budget,
        fingerprint=fingerprint(case, s),
        **fields,
    )


def rows_of(case: Case, settings: Settings, result: Measurement) -> list[Row]:
    """Of one run."""
    out = []
    for f in result.figures:
        verdict = ""
        if f.bound is not None:
            fast = f.bound_rtf is None or result.rtf >= f.bound_rtf
            verdict = "pass" if f.value is not None and f.value <= f.bound and fast else "fail"
        out.append(
            row(
                case,
                settings,
                metric=f.metric,
                error=f.value,
                unit=f.unit,
                rtf=result.rtf if math.isfinite(result.rtf) else None,
                bound=f.bound,
                bound_rtf=f.bound_rtf,
                verdict=verdict,
                residuals=result.residuals,
                note=result.note,
            )
        )
    return out


def without_figure(case: Case, settings: Settings, note: str, verdict: str = "") -> Row:
    """A run that gave nothing."""
    empty = {"metric": "", "error": None, "unit": "", "rtf": None, "bound": None, "bound_rtf": None}
    return row(case, settings, **empty, verdict=verdict, note=note)


def read(path: Path) -> list[Row]:
    """What earlier runs have written."""
    if not path.is_file():
        return []
    return [Row(**fields) for fields in json.loads(path.read_text())["rows"]]


def write(path: Path, rows: Sequence[Row], about: dict[str, Any]) -> None:
    """Writes the file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps({**about, "rows": [asdict(row) for row in rows]}, indent=1, allow_nan=False) + "\n")


def kept(rows: Iterable[Row], case: Case, settings: Settings) -> list[Row]:
    """The rows of a run that need not be done again: nothing has changed, and more time would not finish it."""
    key, mark = run_of(case, settings), fingerprint(case, settings)
    found = [row for row in rows if row.run == key]
    unfinished = any(row.note.startswith(INCOMPLETE) and row.budget < settings.budget for row in found)
    return [] if unfinished or any(row.fingerprint != mark for row in found) else found
