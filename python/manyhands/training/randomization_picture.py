"""The picture of success over ranges: a panel for each."""

import math
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator, PercentFormatter

from manyhands.files import replacing
from manyhands.training.randomization import WHOLE, RandomizedRun

_BINS, _COLUMNS = 10, 4
_LINE, _BAND, _MEAN, _GRID = "#0b6e4f", "#0b6e4f33", "#e08e2b", "#e6e6e6"


def draw_randomization(path: Path, run: RandomizedRun, title: str) -> None:
    """Draws success in parts of each range with its 95 % intervals, and the mean over all episodes. Raises OSError if
    the file cannot be written."""
    rows = math.ceil(len(run.ranges) / _COLUMNS)
    figure = Figure(figsize=(3.2 * _COLUMNS, 2.4 * rows + 0.5), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(rows, _COLUMNS, sharey=True, squeeze=False).flat
    for name, axes in zip(run.ranges, panels, strict=False):
        _panel(axes, run, name)
    for axes in panels:  # what is left of the last row
        axes.set_visible(False)
    mean, n = float(run.success.mean()), len(run.success)
    figure.suptitle(f"{title}: success {mean:.1%} of {n:,} episodes under these ranges", fontweight="bold")
    with replacing(path) as temporary:
        figure.savefig(temporary)


def _panel(axes: Axes, run: RandomizedRun, name: str) -> None:
    bins = run.bins(name, _BINS)
    logarithmic = run.ranges[name][2]
    middle = [math.sqrt(one.low * one.high) if logarithmic else (one.low + one.high) / 2 for one in bins]
    low, high = zip(*(one.interval for one in bins), strict=True)
    axes.axhline(float(run.success.mean()), color=_MEAN, lw=1)
    if len(bins) > 2:
        axes.fill_between(middle, low, high, color=_BAND, lw=0)
    else:
        axes.vlines(middle, low, high, color=_BAND, lw=8)
    axes.plot(middle, [one.success for one in bins], color=_LINE, marker="o", ms=3, lw=1.5 if len(bins) > 2 else 0)
    if logarithmic:
        axes.set_xscale("log")
        axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xlim(bins[0].low, bins[-1].high)
    marked = middle if name in WHOLE else [bins[0].low, bins[len(bins) // 2].low, bins[-1].high]
    axes.set_xticks(marked, [f"{x:.3g}" for x in marked])
    axes.set_ylim(-0.02, 1.04)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_title(name, loc="left", fontsize=10)
    axes.grid(color=_GRID)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
