"""The picture of how a training went."""

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, PercentFormatter

from manyhands.files import replacing
from manyhands.training.evaluation import Evaluation
from manyhands.training.recorder import Row
from manyhands.training.run_folder import RunFolder

_TRAINING, _EVALUATION, _LAST, _VALUE, _GRID = "#e08e2b", "#0b6e4f", "#1d3557", "#c8553d", "#e6e6e6"
_MARGIN = 0.02  # of the width, beside the first and the last point


def draw_curve(folder: RunFolder, rows: Sequence[Row], title: str, last: Evaluation | None = None) -> None:
    """Draws success over environment steps, and the critic's view where there is a critic, into learning_curve.png.

    last: the evaluation after training, if there was one.
    """
    valued = [row for row in rows if row.gradient_steps > 0 and row.policy_q_mean != 0]
    figure = Figure(figsize=(8, 6 if valued else 4.5), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1 + bool(valued), 1, sharex=True, squeeze=False, height_ratios=(2, 1)[: 1 + bool(valued)])
    success, lowest = panels[0, 0], panels[-1, 0]
    _draw_success(success, rows, last)
    success.set_title(title, loc="left", fontweight="bold")
    if valued:
        lowest.plot([row.env_steps for row in valued], [row.policy_q_mean for row in valued], color=_VALUE, lw=1.5)
        lowest.set_ylabel("critic's estimate\nof the return")
    lowest.set_xlabel("environment steps")
    lowest.xaxis.set_major_formatter(EngFormatter(sep=""))
    margin = _MARGIN * max(rows[-1].env_steps, 1)
    lowest.set_xlim(-margin, rows[-1].env_steps + margin)
    for axes in panels[:, 0]:
        axes.grid(color=_GRID)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    with replacing(folder.curve) as temporary:
        figure.savefig(temporary)


def _draw_success(axes: Axes, rows: Sequence[Row], last: Evaluation | None) -> None:
    """Of training, of the evaluations while it went on, and of the one after it; of each, if there was one."""
    known = [row for row in rows if not math.isnan(row.success_rate)]
    if known:
        axes.plot(
            [row.env_steps for row in known],
            [row.success_rate for row in known],
            color=_TRAINING,
            lw=1.5,
            zorder=3,  # above the evaluation's, which is wider: both are seen where they meet
            label="training, with exploration",
        )
    measured = [row for before, row in zip([None, *rows], rows, strict=False) if _is_new_evaluation(before, row)]
    if measured:
        axes.plot(
            [row.env_steps for row in measured],
            [row.evaluation_success_rate for row in measured],
            color=_EVALUATION,
            lw=3,
            marker="o",
            ms=5,
            label="evaluations in between",
        )
    if last is not None:
        label = f"in the end: {last.success_rate:.1%} of {last.episodes} fresh episodes"
        axes.plot(
            rows[-1].env_steps, last.success_rate, color=_LAST, ls="", marker="*", ms=13, zorder=4, clip_on=False,
            label=label,
        )  # fmt: skip
    axes.set_ylim(-0.02, 1.04)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_ylabel("success")
    if axes.has_data():
        axes.legend(loc="lower right", frameon=False)


def _is_new_evaluation(before: Row | None, row: Row) -> bool:
    return row.evaluations > (before.evaluations if before else 0)
