"""Speed-accuracy curves: error against real-time factor, a picture for each case."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.accuracy.case import ENGINES, Case
from benchmarks.accuracy.rows import Row
from benchmarks.accuracy.verdicts import metrics

COLOURS = {"manyhands": "#0b6e4f", "manyhands lanes": "#5bb98c", "MuJoCo": "#c8553d", "PyBullet": "#e08e2b"}
STYLES = ("-", "--", ":", "-.")
GRID = "#e6e6e6"
FLOOR = 1e-32  # an error of zero has no logarithm


def draw(folder: Path, cases: Sequence[Case], rows: Sequence[Row]) -> list[Path]:
    """One picture for each case that has a curve and rows; gives their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = []
    for case in cases:
        mine = [row for row in rows if row.case == case.name and row.error is not None and row.rtf is not None]
        if case.curve and mine:
            path = folder / f"{case.name.replace(' ', '_')}.png"
            picture(case, mine).savefig(path)
            drawn.append(path)
    return drawn


def picture(case: Case, rows: Sequence[Row]) -> Figure:
    """Lines join time steps, crosses are numbers of iterations, diamonds what was published."""
    figure = Figure(figsize=(9, 6), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    metric = metrics(rows)[0]
    rows = [row for row in rows if row.metric == metric]
    for engine in ENGINES:
        mine = [row for row in rows if row.engine == engine]
        for style, kind in zip(STYLES, dict.fromkeys((row.variant, row.integrator) for row in mine), strict=False):
            line(axes, engine, [row for row in mine if (row.variant, row.integrator) == kind], style)
    right = ("axes fraction", "data")
    if case.published:
        best = min(point.error for point in case.published)
        axes.axhline(best, color="#888888", lw=1, zorder=1)
        axes.annotate("best published", (0.99, best), xycoords=right, fontsize=8, ha="right", va="bottom")
        for point in case.published:
            if point.rtf is None:
                axes.axhline(point.error, color="#bbbbbb", lw=0.8, ls="--", zorder=1)
                axes.annotate(point.who, (0.99, point.error), xycoords=right, fontsize=8, ha="right", va="bottom")
                continue
            axes.plot(point.rtf, point.error, "D", color="#444444", ms=5, zorder=4)
            axes.annotate(point.who, (point.rtf, point.error), xytext=(5, 4), textcoords="offset points", fontsize=8)
    asked = rows[0]
    if asked.bound:
        axes.axhline(asked.bound, color=COLOURS["manyhands"], lw=1, ls=(0, (1, 3)), zorder=1)
        if asked.bound_rtf:
            axes.plot(asked.bound_rtf, asked.bound, "*", color=COLOURS["manyhands"], ms=14, zorder=5, label="goal")
    axes.set(xscale="log", yscale="log", xlabel="real-time factor (simulated seconds per second of one core)")
    axes.set_ylabel(f"{metric} [{asked.unit}]" if asked.unit else metric)
    axes.set_title(f"{case.name}: {case.title}", loc="left", fontweight="bold")
    axes.grid(color=GRID)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def line(axes: object, engine: str, rows: Sequence[Row], style: str) -> None:
    """One engine with one set of options."""
    plot = axes.plot  # type: ignore[attr-defined]
    annotate = axes.annotate  # type: ignore[attr-defined]
    colour = COLOURS[engine]
    swept = sorted((row for row in rows if row.iterations is None), key=lambda row: row.time_step)
    kind = ", ".join(filter(None, (rows[0].variant, rows[0].integrator)))
    label = f"{engine} ({kind})" if kind else engine
    if swept:
        plot(
            [r.rtf for r in swept],
            [max(r.error or 0.0, FLOOR) for r in swept],
            style,
            color=colour,
            marker="o",
            ms=4,
            label=label,
        )
        for row in (swept[0], swept[-1]):
            place = (row.rtf, max(row.error or 0.0, FLOOR))
            annotate(
                f"{row.time_step * 1e3:g} ms",
                place,
                xytext=(4, -9),
                textcoords="offset points",
                fontsize=7,
                color=colour,
            )
    counted = sorted((row for row in rows if row.iterations is not None), key=lambda row: row.iterations or 0)
    if counted:
        what = f"{engine}, {', '.join(str(row.iterations) for row in counted)} iterations"
        errors = [max(row.error or 0.0, FLOOR) for row in counted]
        plot([row.rtf for row in counted], errors, ":", color=colour, marker="x", ms=6, lw=0.8, label=what)
