"""The picture of how a training went."""

from collections.abc import Sequence

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, PercentFormatter

from manyhands.training.files import replacing
from manyhands.training.recorder import Row
from manyhands.training.run_folder import RunFolder

_EPISODES_OF_A_RATE = 100  # before so many have ended, the rate is that of the quick ones
_TRAINING, _EVALUATION, _VALUE, _GRID = "#7aa6c2", "#0b6e4f", "#c8553d", "#e6e6e6"


def draw_curve(folder: RunFolder, rows: Sequence[Row], title: str) -> None:
    """Draws success and the critic's view over environment steps into learning_curve.png."""
    figure = Figure(figsize=(8, 6), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    success, value = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    known = [row for row in rows if row.episodes >= _EPISODES_OF_A_RATE]
    success.plot(
        [row.env_steps for row in known],
        [row.success_rate for row in known],
        color=_TRAINING,
        lw=1.5,
        label="training, with exploration",
    )
    measured = [row for before, row in zip([None, *rows], rows, strict=False) if _is_new_evaluation(before, row)]
    success.plot(
        [row.env_steps for row in measured],
        [row.evaluation_success_rate for row in measured],
        color=_EVALUATION,
        lw=2.2,
        marker="o",
        ms=3.5,
        label="evaluation on fresh episodes",
    )
    success.set_xlim(0, rows[-1].env_steps)
    success.set_ylim(-0.02, 1.04)
    success.yaxis.set_major_formatter(PercentFormatter(1.0))
    success.set_ylabel("success")
    success.legend(loc="lower right", frameon=False)
    success.set_title(title, loc="left", fontweight="bold")

    learned = [row for row in rows if row.gradient_steps > 0]
    value.plot([row.env_steps for row in learned], [row.policy_q_mean for row in learned], color=_VALUE, lw=1.5)
    value.set_ylabel("value of the policy")
    value.set_xlabel("environment steps")
    value.xaxis.set_major_formatter(EngFormatter(sep=""))

    for axes in (success, value):
        axes.grid(color=_GRID)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0.01)
    with replacing(folder.curve) as temporary:
        figure.savefig(temporary)


def _is_new_evaluation(before: Row | None, row: Row) -> bool:
    return row.evaluations > (before.evaluations if before else 0)
