"""The picture of how a training went."""

import math
from collections.abc import Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, PercentFormatter

from manyhands.files import replacing
from manyhands.training.recorder import Row
from manyhands.training.run_folder import RunFolder

_TRAINING, _EVALUATION, _VALUE, _GRID = "#e08e2b", "#0b6e4f", "#c8553d", "#e6e6e6"
_MARGIN = 0.02  # of the width, beside the first and the last point


def draw_curve(folder: RunFolder, rows: Sequence[Row], title: str) -> None:
    """Draws success and the critic's view over environment steps into learning_curve.png."""
    figure = Figure(figsize=(8, 6), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    success, value = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    learned = [row for row in rows if row.gradient_steps > 0]
    known = [row for row in rows if not math.isnan(row.success_rate)]
    success.plot(
        [row.env_steps for row in known],
        [row.success_rate for row in known],
        color=_TRAINING,
        lw=1.5,
        zorder=3,  # above the evaluation's, which is wider: both are seen where they meet
        label="training, with exploration",
    )
    measured = [row for before, row in zip([None, *rows], rows, strict=False) if _is_new_evaluation(before, row)]
    success.plot(
        [row.env_steps for row in measured],
        [row.evaluation_success_rate for row in measured],
        color=_EVALUATION,
        lw=3,
        marker="o",
        ms=5,
        label="evaluation on fresh episodes",
    )
    drawn = [*known, *measured, *learned] or rows
    first, last = min(row.env_steps for row in drawn), max(row.env_steps for row in drawn)
    margin = _MARGIN * max(last - first, 1)
    success.set_xlim(first - margin, last + margin)
    success.set_ylim(-0.02, 1.04)
    success.yaxis.set_major_formatter(PercentFormatter(1.0))
    success.set_ylabel("success")
    success.legend(loc="lower right", frameon=False)
    success.set_title(title, loc="left", fontweight="bold")

    value.plot([row.env_steps for row in learned], [row.policy_q_mean for row in learned], color=_VALUE, lw=1.5)
    value.set_ylabel("critic's estimate\nof the return")
    value.set_xlabel("environment steps")
    value.xaxis.set_major_formatter(EngFormatter(sep=""))

    for axes in (success, value):
        axes.grid(color=_GRID)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    with replacing(folder.curve) as temporary:
        figure.savefig(temporary)


def _is_new_evaluation(before: Row | None, row: Row) -> bool:
    return row.evaluations > (before.evaluations if before else 0)
