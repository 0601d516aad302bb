"""What the rows of a case come to, engine by engine."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.accuracy.case import BULLET, ENGINES, LANES, MUJOCO, OURS, Best, Case
from benchmarks.accuracy.rows import INCOMPLETE, Row

DEFAULT_STEPS = (0.002, 0.004)


@dataclass(frozen=True)
class Verdict:
    """Of an engine in a case. `row` is the one that decides; None if there is none."""

    word: str  # "pass", "fail", "cannot", "not run", "shown"
    figure: Row | None = None
    note: str = ""


def metrics(rows: Sequence[Row]) -> list[str]:
    """In the order of the case."""
    return list(dict.fromkeys(row.metric for row in rows if row.metric))


def of(case: Case, rows: Sequence[Row], engine: str, metric: str) -> Verdict:
    """The verdict on one figure: of the variant that does best, over what the case asks for."""
    mine = [row for row in rows if row.case == case.name and row.engine == engine]
    if not mine:
        return Verdict("not run")
    figures = [row for row in mine if row.metric == metric]
    if not figures:
        stopped = [row for row in mine if row.note.startswith(INCOMPLETE)]
        word = "cannot" if all(row.note.startswith("cannot") for row in mine) else "fail"
        return Verdict(word, None, (stopped or mine)[0].note)
    if case.judge == "curve":
        return best(figures, rows)
    variants = dict.fromkeys((row.variant, row.integrator) for row in mine)
    verdicts = [over_steps([r for r in mine if (r.variant, r.integrator) == v], metric) for v in variants]
    order = {"pass": 0, "shown": 1, "fail": 2}
    return min(verdicts, key=lambda v: (order[v.word], badness(v.figure)))


def badness(row: Row | None) -> float:
    """For sorting: no figure is worst."""
    return float("inf") if row is None or row.error is None else row.error


def over_steps(mine: Sequence[Row], metric: str) -> Verdict:
    """The worst at 2 and 4 ms with default iterations; it passes if all pass."""
    judged = [row for row in mine if row.iterations is None and row.time_step in DEFAULT_STEPS]
    judged = judged or list(mine)
    figures = [row for row in judged if row.metric == metric]
    stopped = [row for row in judged if row.error is None]
    if not figures:
        return Verdict("fail", None, judged[0].note)
    worst = max(figures, key=badness)
    if worst.bound is None:
        return Verdict("shown", worst)
    passed = not stopped and all(row.verdict == "pass" for row in figures)
    return Verdict("pass" if passed else "fail", worst, stopped[0].note if stopped else "")


def best(figures: Sequence[Row], rows: Sequence[Row]) -> Verdict:
    """One point of the curve is enough: the most accurate that is fast enough."""
    fast = [row for row in figures if row.bound_rtf is None or (row.rtf or 0.0) >= row.bound_rtf]
    row = min(fast or figures, key=badness)
    if row.bound is not None:
        return Verdict("pass" if row.verdict == "pass" else "fail", row)
    others = [r for r in rows if (r.case, r.metric) == (row.case, row.metric) and r.engine not in (OURS, LANES)]
    if row.engine not in (OURS, LANES) or not others:
        return Verdict("shown", row)
    rival = min(others, key=badness)
    return Verdict("pass" if badness(row) <= badness(rival) else "fail", row, f"least of the others: {rival.error:.2g}")


def beyond(case: Case, rows: Sequence[Row], engine: str, point: Best) -> Row | None:
    """The most accurate row of an engine that is as fast as a published point."""
    metric = metrics([row for row in rows if row.case == case.name])[:1]
    fast = [
        row
        for row in rows
        if row.case == case.name
        and row.engine == engine
        and [row.metric] == metric
        and (row.rtf or 0.0) >= (point.rtf or 0.0)
    ]
    return min(fast, key=badness) if fast else None


def word_of_case(case: Case, rows: Sequence[Row], engine: str) -> str:
    """All figures together."""
    words = [
        of(case, rows, engine, metric).word for metric in metrics([r for r in rows if r.case == case.name]) or [""]
    ]
    for word in ("not run", "cannot", "fail", "pass"):
        if word in words:
            return word
    return "shown"


__all__ = ["BULLET", "ENGINES", "MUJOCO", "Verdict", "beyond", "metrics", "of", "word_of_case"]
