"""Pictures of recorded runs, with one call."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands.recording import Recording

Array = NDArray[np.float64]


class Panel(NamedTuple):
    """One plot among others."""

    title: str
    unit: str
    names: list[str]
    values: Array
    """(n, k)"""


def plot(run: Recording | str | Path, out: str | Path) -> Path:
    """Draws joint positions, velocities and forces, contact forces, the hand's path and rewards of a run, as far as
    they were recorded: a PNG, or an HTML page to zoom in that opens alone, as the name of `out` ends.

    run: a recording or its file. Raises ValueError on another ending or an empty recording, ModuleNotFoundError without
    the extra `plots`.
    """
    out = Path(out)
    draw = {".png": _png, ".html": _html}.get(out.suffix)
    if draw is None:
        raise ValueError(f"{out} ends with {out.suffix!r}; expected .png or .html")
    recording = run if isinstance(run, Recording) else Recording.load(run)
    draw(recording, panels(recording), out)
    return out


def panels(run: Recording) -> list[Panel]:
    """What there is to draw. Raises ValueError on an empty recording."""
    if len(run.time) == 0:
        raise ValueError("the recording is empty")
    joints = [name.rpartition("/")[2] for name in run.joints]
    found = [
        Panel("Joint positions", "rad, m", joints, run.positions),
        Panel("Joint velocities", "rad/s, m/s", joints, run.velocities),
        Panel("Joint forces", "N m, N", joints, run.forces),
        Panel("Contact forces", "N", run.touched, run.contacts),
        Panel("Hand", "m", ["x", "y", "z"], run.hand),
        Panel("Reward", "", ["reward"], run.rewards[:, None]),
    ]
    return [panel for panel in found if panel.values.size]


def _png(run: Recording, drawn: list[Panel], out: Path) -> None:
    import matplotlib.figure

    rows = (len(drawn) + 1) // 2
    figure = matplotlib.figure.Figure(figsize=(12, 3.2 * rows), layout="constrained")
    axes: Any = figure.subplots(rows, 2, squeeze=False).ravel()
    for axis, panel in zip(axes, drawn, strict=False):
        axis.plot(run.time[-len(panel.values) :], panel.values, linewidth=1.4, label=panel.names)
        axis.set_title(f"{panel.title} [{panel.unit}]" if panel.unit else panel.title)
        axis.set_xlabel("t [s]")
        axis.grid(alpha=0.3)
        if len(panel.names) > 1:
            axis.legend(fontsize="x-small", ncols=1 + len(panel.names) // 5)
    for axis in axes[len(drawn) :]:
        axis.set_axis_off()
    figure.savefig(out, dpi=120)


def _html(run: Recording, drawn: list[Panel], out: Path) -> None:
    from plotly.graph_objects import Figure, Scatter
    from plotly.subplots import make_subplots

    rows = (len(drawn) + 1) // 2
    titles = [f"{panel.title} [{panel.unit}]" if panel.unit else panel.title for panel in drawn]
    figure: Figure = make_subplots(rows, 2, subplot_titles=titles, vertical_spacing=0.3 / rows)
    for k, panel in enumerate(drawn):
        time = run.time[-len(panel.values) :]
        for name, column in zip(panel.names, panel.values.T, strict=True):
            line = Scatter(x=time, y=column, name=name, legendgroup=panel.title, legendgrouptitle_text=panel.title)
            figure.add_trace(line, row=k // 2 + 1, col=k % 2 + 1)
    figure.update_xaxes(title_text="t [s]", matches="x")
    figure.update_layout(height=320 * rows, template="plotly_white", margin={"t": 50, "b": 30})
    figure.write_html(out, include_plotlyjs=True)
