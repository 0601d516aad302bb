"""The table that people read: verdicts, what was published, and every row if asked."""

from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from benchmarks.accuracy.case import ENGINES, OURS, Case
from benchmarks.accuracy.rows import Row
from benchmarks.accuracy.verdicts import Verdict, beyond, metrics, of

MARKS = {"pass": "✓", "fail": "✗", "cannot": "cannot", "not run": "-", "shown": ""}
COLOURS = {"pass": "green", "fail": "red", "cannot": "dim", "not run": "dim", "shown": "default"}


def number(value: float | None) -> str:
    """Two digits, an exponent where it is shorter."""
    if value is None:
        return "none"
    return "0" if value == 0 else f"{value:.3g}" if 0.01 <= abs(value) < 1000 else f"{value:.1e}"


def speed(row: Row) -> str:
    """The real-time factor."""
    return "" if row.rtf is None else f"{row.rtf:.0f}x" if row.rtf >= 10 else f"{row.rtf:.1f}x"


def setting(row: Row) -> str:
    """What the row was run with."""
    words = [f"{row.time_step * 1e3:g} ms", row.integrator, row.variant]
    words += [f"{row.iterations} it."] if row.iterations is not None else []
    return ", ".join(filter(None, words))


def bound(row: Row) -> str:
    """What is asked."""
    if row.bound is None:
        return ""
    fast = "" if row.bound_rtf is None else f" at {row.bound_rtf:g}x"
    return f"≤ {number(row.bound)}{fast}"


def cell(verdict: Verdict) -> str:
    """One engine's figure."""
    row = verdict.figure
    if row is None:
        return MARKS[verdict.word] if verdict.word != "fail" else f"✗ {verdict.note[:40]}"
    return f"{number(row.error)} {MARKS[verdict.word]} ({setting(row)}; {speed(row)})"


def summary(cases: Iterable[Case], rows: Sequence[Row]) -> list[list[str]]:
    """Lines of case, figure, bound and a cell for each engine."""
    lines = []
    for case in cases:
        mine = [row for row in rows if row.case == case.name]
        for k, metric in enumerate(metrics(mine) or [""]):
            asked = next((row for row in mine if row.metric == metric), None)
            figure = f"{metric}{f' [{asked.unit}]' if asked is not None and asked.unit else ''}"
            cells = [cell(of(case, rows, engine, metric)) for engine in ENGINES]
            lines.append([case.name if k == 0 else "", figure, bound(asked) if asked else "", *cells])
    return lines


def published(cases: Iterable[Case], rows: Sequence[Row]) -> list[list[str]]:
    """Lines of case, published point, and the best of each engine that is as fast."""
    lines = []
    for case in cases:
        for k, point in enumerate(case.published):
            cells, fast = [], "" if point.rtf is None else f" at {point.rtf:g}x"
            for engine in (OURS, "MuJoCo", "PyBullet"):
                row = beyond(case, rows, engine, point)
                mark = "" if row is None else "✓" if row.error is not None and row.error <= point.error else "✗"
                cells.append("-" if row is None else f"{number(row.error)} {mark} ({speed(row)})")
            lines.append([case.name if k == 0 else "", f"{point.who}: {number(point.error)}{fast}", *cells])
    return lines


HEADINGS = ["case", "figure", "must be", *ENGINES]
PUBLISHED_HEADINGS = ["case", "published (2018, one core of an i7-7700HQ)", OURS, "MuJoCo", "PyBullet"]


def show(console: Console, cases: Sequence[Case], rows: Sequence[Row], everything: bool) -> None:
    """Prints it."""
    table = Table(*HEADINGS, title="Accuracy: error, verdict, and the setting it was reached with", show_lines=False)
    for line in summary(cases, rows):
        table.add_row(*map(escape, line))
    console.print(table)
    if any(case.published for case in cases):
        table = Table(*PUBLISHED_HEADINGS, title="Published points, and the best that is as fast")
        for line in published(cases, rows):
            table.add_row(*map(escape, line))
        console.print(table)
    if everything:
        table = Table("case", "engine", "setting", "figure", "error", "RTF", "must be", "verdict", "residuals", "note")
        for row in rows:
            residuals = " ".join(f"{name} {number(value)}" for name, value in row.residuals.items())
            figure: list[str] = [
                row.metric,
                number(row.error),
                speed(row),
                bound(row),
                row.verdict,
                residuals,
                row.note,
            ]
            table.add_row(*map(escape, (row.case, row.engine, setting(row), *figure)))
        console.print(table)


def markdown(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A table for documents."""
    out = [f"| {' | '.join(headings)} |", f"| {' | '.join('---' for _ in headings)} |"]
    return "\n".join([*out, *(f"| {' | '.join(line)} |" for line in lines)])
