"""The table that people read, and the file that programs read."""

import datetime
import json
import os
import platform
import subprocess
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.rows import NOISY, Row
from manyhands.files import write_text

HEADINGS = ("benchmark", "engine", "number type", "threads", "value", "unit", "±", "ratio", "target", "")
STAGE = "Reach step: "
CONTACT_STAGE = "Contact step, "  # scene: stage


def machine() -> dict[str, Any]:
    """Where and when the figures were taken."""
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
        "cpu": cpu_model(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),
        "compiler": first_line([os.environ.get("CXX", "c++"), "--version"]),
        "python": platform.python_version(),
        "system": platform.platform(),
    }


def cpu_model() -> str:
    """The name that Linux gives the processor."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor()
    names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return names[0] if names else platform.machine()


def first_line(command: Sequence[str]) -> str:
    """What a program says of itself, or "unknown"."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return "unknown"


def table(rows: Sequence[Row]) -> str:
    """All rows but those of stages, in columns."""
    cells = [HEADINGS, *(cells_of(row) for row in rows if not row.benchmark.startswith(STAGE))]
    widths = [max(len(line[k]) for line in cells) for k in range(len(HEADINGS))]
    right = {3, 4, 6, 7}
    lines = [
        "  ".join(c.rjust(w) if k in right else c.ljust(w) for k, (c, w) in enumerate(zip(line, widths, strict=True)))
        for line in cells
    ]
    lines.insert(1, "  ".join("-" * w for w in widths))
    return "\n".join(line.rstrip() for line in lines)


def cells_of(row: Row) -> tuple[str, ...]:
    """A row as text."""
    noisy = "noisy" if row.variation is not None and row.variation > NOISY else ""
    return (
        row.benchmark,
        row.engine,
        row.number_type,
        str(row.threads),
        "-" if row.value is None else number(row.value),
        row.unit,
        "" if row.variation is None else f"{100 * row.variation:.0f}%",
        "" if row.ratio is None else f"{number(row.ratio)}x {row.ratio_to}",
        row.target,
        ", ".join(filter(None, (row.verdict, noisy, row.note))),
    )


def number(value: float) -> str:
    """Three or more digits, no exponent."""
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}" if value >= 100 else f"{value:.2f}"


def stage_tree(rows: Sequence[Row]) -> str:
    """Where an environment step's time goes: nanoseconds and shares, a column for each number type."""
    stages = [row for row in rows if row.benchmark.startswith(STAGE)]
    if not stages:
        return ""
    types = list(dict.fromkeys(row.number_type for row in stages))
    ns = {(row.benchmark.removeprefix(STAGE), row.number_type): row.value for row in stages}
    names = list(dict.fromkeys(name for name, _ in ns))
    parts = [name for name in names if name != "all"]
    lines = ["Reach step, ns per environment step".ljust(38) + "".join(f"{t:>18}" for t in types)]

    def line(text: str, values: dict[str, float | None], totals: dict[str, float | None]) -> str:
        cells = []
        for kind in types:
            value, total = values[kind], totals[kind]
            cells.append(f"{value:,.0f} {100 * value / total:4.0f}%" if value is not None and total else "-")
        return text.ljust(38) + "".join(f"{cell:>18}" for cell in cells)

    def known_sum(kind: str) -> float | None:
        values = [ns.get((part, kind)) for part in parts]
        return None if None in values else sum(value for value in values if value is not None)

    sums = {kind: known_sum(kind) for kind in types}
    totals = {kind: ns.get(("all", kind)) or sums[kind] for kind in types}
    lines.append(line("all", totals, totals))
    lines += [line(f"├─ {part}", {kind: ns.get((part, kind)) for kind in types}, totals) for part in parts]
    rest = {k: None if totals[k] is None or sums[k] is None else (totals[k] or 0) - (sums[k] or 0) for k in types}
    lines.append(line("└─ rows, outcomes, and what is between", rest, totals))
    return "\n".join(lines)


def contact_stages(rows: Sequence[Row]) -> str:
    """Where a substep in contact spends its time: nanoseconds and shares, a column for each scene."""
    ns: dict[str, dict[str, float]] = {}  # by scene and stage
    for row in rows:
        if row.benchmark.startswith(CONTACT_STAGE) and row.value is not None:
            scene, stage = row.benchmark.removeprefix(CONTACT_STAGE).split(": ", 1)
            ns.setdefault(scene, {})[stage] = row.value
    if not ns:
        return ""
    lines = ["contact, ns per substep and world".ljust(38) + "".join(f"{scene:>18}" for scene in ns)]
    totals = {scene: sum(stages.values()) for scene, stages in ns.items()}
    stages = list(dict.fromkeys(stage for stages in ns.values() for stage in stages))
    for text, values in [("all", totals), *((s, {scene: ns[scene].get(s, 0.0) for scene in ns}) for s in stages)]:
        cells = [f"{value:,.0f} {100 * value / totals[scene]:4.0f}%" for scene, value in values.items()]
        lines.append(text.ljust(38) + "".join(f"{cell:>18}" for cell in cells))
    return "\n".join(lines)


def write_json(path: Path, rows: Sequence[Row], about: dict[str, Any]) -> None:
    """Writes the file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, json.dumps({**about, "rows": [asdict(row) for row in rows]}, indent=1, allow_nan=False) + "\n")
