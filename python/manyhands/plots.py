"""Pictures of recorded runs, of trajectories and of workspaces, with one call."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model
from manyhands.control.responses import StepResponse, step_response
from manyhands.dynamics import rnea
from manyhands.extras import needs
from manyhands.files import replacing
from manyhands.planning import Sample, Trajectory
from manyhands.planning.trajectories import limit_row
from manyhands.recording import Recording
from manyhands.workspace import Workspace

Array = NDArray[np.float64]

PALETTE = (
    "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22", "#17becf",
    "#0b3d91", "#ffb000", "#006d5b", "#e6194b", "#4b0082", "#5fd35f", "#222222", "#ff1493", "#6b8e23", "#00bfff",
)  # fmt: skip


class Panel(NamedTuple):
    """One plot among others."""

    title: str
    unit: str
    names: list[str]
    values: Array
    """(n, k)"""
    limits: Array | None = None
    """(k,), drawn on both sides of 0 where they are finite"""


def plot(run: Recording | str | Path, out: str | Path) -> Path:
    """Draws joint positions, velocities and forces, contact forces, the hand's path and rewards of a run, as far as
    they were recorded: a PNG, or an HTML page to zoom in that opens alone, as the name of `out` ends.

    run: a recording or its file. Raises ValueError on another ending or an empty recording, ModuleNotFoundError without
    the extra `plots`.
    """
    out = Path(out)
    draw = _by_ending(out, _png, _html)
    recording = run if isinstance(run, Recording) else Recording.load(run)
    drawn = panels(recording)
    with needs("plots", "a plot"), replacing(out) as temporary:
        draw(recording.time, drawn, temporary)
    return out


def plot_trajectory(
    motion: Trajectory,
    out: str | Path,
    *,
    velocity: ArrayLike | None = None,
    acceleration: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    model: Model | None = None,
    names: list[str] | None = None,
) -> Path:
    """Draws the positions, velocities and accelerations of a trajectory over time, with limits (n,), or one for all, as
    dashed lines; with a model the torques, too, that inverse dynamics says. A PNG or an HTML page, as `plot`.

    names: (n,) of the joints. Raises as `plot`, and ValueError on arrays that do not fit.
    """
    out = Path(out)
    draw = _by_ending(out, _png, _html)
    time = np.linspace(0.0, motion.duration, _SAMPLES)
    limits = {"velocity": velocity, "acceleration": acceleration, "torque": torque}
    drawn = _trajectory_panels(motion.sample(time), model, names, limits)
    with needs("plots", "a plot"), replacing(out) as temporary:
        draw(time, drawn, temporary)
    return out


def _trajectory_panels(
    found: Sample, model: Model | None, names: list[str] | None, limits: dict[str, ArrayLike | None]
) -> list[Panel]:
    n = found.q.shape[1]
    if names is None:
        names = [f"joint {k}" for k in range(n)]
    if len(names) != n:
        raise ValueError(f"there are {len(names)} names for {n} joints; expected as many")
    velocity, acceleration, torque = (
        None if given is None else limit_row(name, given, n) for name, given in limits.items()
    )
    drawn = [
        Panel("Joint positions", "rad, m", names, found.q),
        Panel("Joint velocities", "rad/s, m/s", names, found.v, velocity),
        Panel("Joint accelerations", "rad/s², m/s²", names, found.a, acceleration),
    ]
    if model is not None:
        drawn.append(Panel("Joint forces", "N m, N", names, rnea(model, *found), torque))
    return drawn


def plot_step_response(
    time: ArrayLike,
    responses: Mapping[str, ArrayLike],
    set_point: float,
    out: str | Path,
    *,
    start: float | None = None,
    tolerance: float = 0.02,
) -> Path:
    """Draws responses (n,) to a step over time (n,) [s], by their names, with the set point, the band of `tolerance`
    about it, and rise time, overshoot and settling time in the legend. A PNG or an HTML page, as `plot`; raises as it
    does, and as `step_response`."""
    out = Path(out)
    draw = _by_ending(out, _step_png, _step_html)
    t = np.asarray(time, np.float64)
    measured = {
        f"{name}: {_measures(step_response(t, values, set_point, start=start, tolerance=tolerance))}": np.asarray(
            values
        )
        for name, values in responses.items()
    }
    if not measured:
        raise ValueError("there are no responses to draw")
    begin = float(next(iter(measured.values()))[0]) if start is None else start
    with needs("plots", "a plot"), replacing(out) as temporary:
        draw(t, measured, set_point, abs(set_point - begin) * tolerance, temporary)
    return out


def _measures(found: StepResponse) -> str:
    settled = f"settles in {found.settling_time:.3g} s" if math.isfinite(found.settling_time) else "does not settle"
    risen = f"rises in {found.rise_time:.3g} s" if math.isfinite(found.rise_time) else "does not rise"
    return f"{risen}, overshoots by {found.overshoot:.1%}, {settled}"


def plot_workspace(found: Workspace, out: str | Path) -> Path:
    """Draws where a frame can be, coloured by its mean manipulability: a PNG from above and from the side, or an HTML
    page with its points in space, as the name of `out` ends. Raises as `plot`."""
    out = Path(out)
    draw = _by_ending(out, _workspace_png, _workspace_html)
    with needs("plots", "a plot"), replacing(out) as temporary:
        draw(found, temporary)
    return out


def _by_ending(out: Path, png: Any, html: Any) -> Any:
    """What draws a file of that name."""
    draw = {".png": png, ".html": html}.get(out.suffix)
    if draw is None:
        raise ValueError(f"{out} ends with {out.suffix!r}; expected .png or .html")
    return draw


def panels(run: Recording) -> list[Panel]:
    """What there is to draw. Raises ValueError on a recording without anything."""
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
    found = [panel for panel in found if panel.values.size]
    if not found:
        raise ValueError("the recording has nothing to draw: no joints, contacts, hand or rewards")
    return found


def _colours(drawn: list[Panel]) -> dict[str, str]:
    """One for each name, the same in all panels."""
    names = dict.fromkeys(name for panel in drawn for name in panel.names)
    return {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(names)}


def _heading(panel: Panel) -> str:
    return f"{panel.title} [{panel.unit}]" if panel.unit else panel.title


def _columns(drawn: list[Panel]) -> int:
    """Of panels: two, but of one that is alone."""
    return min(len(drawn), 2)


def _limits(panel: Panel) -> list[tuple[str, float]]:
    """Where lines are drawn, and whose limits they are."""
    if panel.limits is None:
        return []
    pairs = zip(panel.names, panel.limits.tolist(), strict=True)
    return [(name, side * limit) for name, limit in pairs if math.isfinite(limit) for side in (1, -1)]


def _png(time: Array, drawn: list[Panel], out: Path) -> None:
    import matplotlib.figure

    columns, colours = _columns(drawn), _colours(drawn)
    rows = math.ceil(len(drawn) / columns)
    figure = matplotlib.figure.Figure(figsize=(7 * columns, 3.2 * rows), layout="constrained")
    grid = figure.add_gridspec(rows, columns)
    for k, panel in enumerate(drawn):
        is_wide = k == len(drawn) - 1 and k % columns == 0
        axis = figure.add_subplot(grid[k // columns, :] if is_wide else grid[k // columns, k % columns])
        for name, column in zip(panel.names, panel.values.T, strict=True):
            axis.plot(time[-len(panel.values) :], column, linewidth=1.4, label=name, color=colours[name])
        for name, limit in _limits(panel):
            axis.axhline(limit, linewidth=0.8, linestyle="--", color=colours[name])
        axis.set_title(_heading(panel))
        axis.set_xlabel("t [s]")
        axis.grid(alpha=0.3)
        if len(panel.names) > 1:
            axis.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    figure.savefig(out, dpi=120)


def _html(time: Array, drawn: list[Panel], out: Path) -> None:
    from plotly.graph_objects import Figure, Scatter
    from plotly.subplots import make_subplots

    columns, colours = _columns(drawn), _colours(drawn)
    rows = math.ceil(len(drawn) / columns)
    specs: list[list[Any]] = [[{}] * columns for _ in range(rows)]
    if len(drawn) < rows * columns:
        specs[-1] = [{"colspan": columns}, None]
    titles = [_heading(panel) for panel in drawn]
    figure: Figure = make_subplots(rows, columns, specs=specs, subplot_titles=titles, vertical_spacing=0.3 / rows)
    named: set[str] = set()
    for k, panel in enumerate(drawn):
        for name, column in zip(panel.names, panel.values.T, strict=True):
            line = Scatter(
                x=time[-len(panel.values) :], y=column, name=name, legendgroup=name, showlegend=name not in named,
                mode="lines", line={"color": colours[name], "width": 1.5},
            )  # fmt: skip
            figure.add_trace(line, row=k // columns + 1, col=k % columns + 1)
            named.add(name)
        for name, limit in _limits(panel):
            dashes = {"color": colours[name], "width": 1, "dash": "dash"}
            figure.add_hline(limit, line=dashes, row=k // columns + 1, col=k % columns + 1)  # type: ignore[arg-type]
    figure.update_xaxes(title_text="t [s]", matches="x")
    figure.update_layout(height=max(320 * rows, 420), template="plotly_white", margin={"t": 50, "b": 30})
    figure.write_html(out, include_plotlyjs=True)


def _step_png(time: Array, responses: dict[str, Array], set_point: float, band: float, out: Path) -> None:
    import matplotlib.figure

    figure = matplotlib.figure.Figure(figsize=(9, 4.5), layout="constrained")
    axis = figure.add_subplot()
    axis.axhspan(set_point - band, set_point + band, color="0.9")
    axis.axhline(set_point, color="0.4", linewidth=0.8, linestyle="--")
    for (name, values), colour in zip(responses.items(), PALETTE, strict=False):
        axis.plot(time, values, linewidth=1.4, label=name, color=colour)
    axis.set(title="Step response", xlabel="t [s]")
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small", loc="lower right")
    figure.savefig(out, dpi=120)


def _step_html(time: Array, responses: dict[str, Array], set_point: float, band: float, out: Path) -> None:
    from plotly.graph_objects import Figure, Scatter

    lines = [Scatter(x=time, y=values, name=name, mode="lines") for name, values in responses.items()]
    figure = Figure(lines)
    figure.add_hrect(set_point - band, set_point + band, line_width=0, fillcolor="black", opacity=0.08)
    figure.add_hline(set_point, line={"width": 1, "dash": "dash"})
    figure.update_layout(title="Step response", xaxis_title="t [s]", template="plotly_white", legend={"y": -0.2})
    figure.write_html(out, include_plotlyjs=True)


_SAMPLES = 2000  # of a trajectory
_CELLS = 60  # across a view
_MOST_POINTS = 20_000  # that a page can turn smoothly


def _workspace_png(found: Workspace, out: Path) -> None:
    import matplotlib.figure

    figure = matplotlib.figure.Figure(figsize=(12, 5.4), layout="constrained")
    scale: dict[str, Any] = {"vmin": 0, "vmax": float(np.quantile(found.measure, 0.9)), "reduce_C_function": np.mean}

    def view(place: int, title: str, across: int, up: int) -> Any:
        axis = figure.add_subplot(1, 2, place)
        x, y = found.position[:, across], found.position[:, up]
        axis.set(title=title, xlabel=f"{'xyz'[across]} [m]", ylabel=f"{'xyz'[up]} [m]", aspect="equal")
        axis.grid(alpha=0.3)
        return axis.hexbin(x, y, found.measure, gridsize=_CELLS, mincnt=1, **scale)

    view(1, "From above", 0, 1)
    cells = view(2, "From the side", 0, 2)
    figure.colorbar(cells, ax=figure.axes, label="mean manipulability")
    figure.suptitle(f"Where {found.frame} can be")
    figure.savefig(out, dpi=120)


def _workspace_html(found: Workspace, out: Path) -> None:
    from plotly.graph_objects import Figure, Scatter3d

    x, y, z = found.position[:_MOST_POINTS].T
    marker = {"size": 2, "color": found.measure[:_MOST_POINTS], "colorscale": "Viridis", "showscale": True}
    figure = Figure(Scatter3d(x=x, y=y, z=z, mode="markers", marker=marker))
    titles = {f"{name}axis": {"title": f"{name} [m]"} for name in "xyz"}
    figure.update_layout(title=f"Where {found.frame} can be", scene={"aspectmode": "data", **titles})
    figure.write_html(out, include_plotlyjs=True)
