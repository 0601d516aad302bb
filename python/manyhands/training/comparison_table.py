"""Groups of runs as rows of text, for the terminal and for the page."""

import numpy as np

from manyhands.training.comparison import Band, Group, interval


def notes(band: Band) -> str:
    """What the columns are."""
    interval = "95 %: bootstrap interval of the mean; " if band == "bootstrap" else ""
    return f"{interval}steps and seconds: of the longest run"


def header(band: Band) -> tuple[str, ...]:
    """Names of the columns."""
    return ("settings", "runs", "worst", "mean", *(["95 %"] if band == "bootstrap" else []), "best", "steps", "seconds")


def table_row(group: Group, band: Band) -> tuple[str, ...]:
    """The cells under `header`: success in the end, and what the longest training took."""
    last = np.array([run.last for run in group.runs])
    count = len(last)
    around: list[str] = []
    if band == "bootstrap":
        low, high = (float(limit[0]) for limit in interval(last[:, None], band))
        around.append(f"{100 * low:.1f} to {high:.1%}" if count > 1 else "")
    return (
        group.label,
        str(count) if group.done == count else f"{count}, {count - group.done} not done",
        f"{last.min():.1%}",
        f"{last.mean():.1%}",
        *around,
        f"{last.max():.1%}",
        f"{max(run.steps[-1] for run in group.runs):,.0f}",
        f"{max(run.seconds[-1] for run in group.runs):,.1f}",
    )
