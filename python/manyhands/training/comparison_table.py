"""Groups of runs as rows of text, for the terminal and for the page."""

from collections.abc import Sequence

import numpy as np

from manyhands.training.comparison import Band, Group, interval


def notes(groups: Sequence[Group], band: Band) -> str:
    """What the columns are."""
    interval = "95 %: bootstrap interval of the mean; " if band == "bootstrap" else ""
    is_mixed = any(0 < len(group.done) < len(group.runs) for group in groups)
    stopped = "; runs that were stopped do not count beside those that are done" if is_mixed else ""
    return f"{interval}steps and seconds: of the longest run{stopped}"


def header(band: Band) -> tuple[str, ...]:
    """Names of the columns."""
    return ("settings", "runs", "worst", "mean", *(["95 %"] if band == "bootstrap" else []), "best", "steps", "seconds")


def table_row(group: Group, band: Band) -> tuple[str, ...]:
    """The cells under `header`: success in the end, and what the longest training took."""
    runs = group.counted
    last = np.array([run.last for run in runs])
    done, count = len(group.done), len(group.runs)
    around: list[str] = []
    if band == "bootstrap":
        low, high = (float(limit[0]) for limit in interval(last[:, None], band))
        around.append(f"{100 * low:.1f} to {high:.1%}" if len(runs) > 1 else "")
    return (
        group.label,
        str(count) if done == count else f"{done} of {count} done",
        f"{last.min():.1%}",
        f"{last.mean():.1%}",
        *around,
        f"{last.max():.1%}",
        f"{max(run.steps[-1] for run in runs):,.0f}",
        f"{max(run.seconds[-1] for run in runs):,.1f}",
    )
