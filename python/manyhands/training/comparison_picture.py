"""Draws runs side by side: a PNG, and a page that opens alone."""

import math
from collections.abc import Sequence
from html import escape
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, PercentFormatter

from manyhands.files import replacing, write_text
from manyhands.plots import PALETTE
from manyhands.training.comparison import Along, Band, Group, interval
from manyhands.training.comparison_table import header, notes, table_row
from manyhands.training.console import counted

AXES: dict[Along, str] = {"steps": "environment steps", "seconds": "seconds of training"}
_GRID, _MUTED = "#e6e6e6", "#666666"
_MARGIN = 0.03  # of an axis, beyond the last point
_NAMED_INSIDE = (4, 45)  # groups, and letters of a name; others stand below the picture
_LETTERS = 130  # that fit below it side by side
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 1100px; margin: 2em auto; padding: 0 1em }
h1 { font-size: 1.4em; margin-bottom: 0 }
p { color: #666; margin-top: 0.3em }
table { border-collapse: collapse; margin: 1em 0 }
th, td { padding: 0.3em 1em 0.3em 0; text-align: right; border-bottom: 1px solid #e6e6e6; font-variant-numeric: tabular-nums }
th:first-child, td:first-child { text-align: left }
"""  # noqa: E501


def explanation(groups: Sequence[Group], band: Band) -> str:
    """What lines and bands are."""
    if all(len(group.runs) == 1 for group in groups):
        return "Success on fresh episodes without exploration, at each evaluation and after training."
    what = "95 % bootstrap interval of the mean" if band == "bootstrap" else "least and greatest"
    thin = ", dashed if stopped" if any(len(group.done) < len(group.runs) for group in groups) else ""
    return f"Success on fresh episodes without exploration: mean over runs, {what}; thin lines are single runs{thin}."


def draw_png(groups: Sequence[Group], band: Band, path: Path) -> None:
    """Success against steps and against seconds. Raises OSError where nothing can be written."""
    columns, lines = _legend_size(groups)
    most, longest = _NAMED_INSIDE
    is_inside = len(groups) <= most and max(len(name_of(group)) for group in groups) <= longest
    figure = Figure(figsize=(11, 4.6 + (0 if is_inside else 0.25 * lines)), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, 2, sharey=True)
    for along, axes in zip(AXES, panels, strict=True):
        for group, colour in zip(groups, cycle(PALETTE), strict=False):
            _draw_group(axes, group, along, band, colour)
        axes.set_xlabel(AXES[along])
        axes.set_xlim(0, _reach(groups, along))
        axes.xaxis.set_major_formatter(thousands)
        axes.grid(color=_GRID)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylim(-0.02, 1.04)
    panels[0].yaxis.set_major_formatter(PercentFormatter(1.0))
    panels[0].set_ylabel("success")
    if is_inside:
        panels[1].legend(loc="lower right", framealpha=0.85, edgecolor="none")
    else:
        named = panels[1].get_legend_handles_labels()
        figure.legend(*named, loc="outside lower left", ncols=columns, frameon=False)
    panels[0].set_title(groups[0].runs[0].env_id, loc="left", fontweight="bold", pad=20)
    below = panels[0].text(0, 1.025, explanation(groups, band), transform=panels[0].transAxes, color=_MUTED, fontsize=9)
    below.set_in_layout(False)  # it is as wide as both panels
    with replacing(path) as temporary:
        figure.savefig(temporary)


def _reach(groups: Sequence[Group], along: Along) -> float:
    """Where an axis ends."""
    return (1 + _MARGIN) * max(x[-1] for group in groups for _, x, _ in group.single(along))


def thousands(value: float, _: int) -> str:
    """25000 as 25k, and 0.25 as it is: not as 250m."""
    return EngFormatter(sep="")(value) if abs(value) >= 1 else f"{value:g}"


def _draw_group(axes: Any, group: Group, along: Along, band: Band, colour: str) -> None:
    x, curves = group.curves(along)
    if len(curves) > 1:
        axes.fill_between(x, *interval(curves, band), color=colour, alpha=0.18, lw=0)
    if len(group.runs) > 1:
        for run, places, success in group.single(along):
            style = "-" if run.is_done else "--"
            axes.plot(places, success, style, color=colour, lw=0.7, alpha=0.45)
            axes.plot(
                places[-1], success[-1], "o", color=colour, ms=4, alpha=0.6, mfc=colour if run.is_done else "white"
            )
    mean = curves.mean(axis=0)
    axes.plot(x, mean, color=colour, lw=2.2, label=name_of(group), solid_capstyle="round")
    axes.plot(x[-1], mean[-1], "o", color=colour, ms=6)


def _legend_size(groups: Sequence[Group]) -> tuple[int, int]:
    """Columns and lines of the names below a picture."""
    columns = max(1, _LETTERS // max(len(name_of(group)) + 6 for group in groups))
    return columns, math.ceil(len(groups) / columns)


def name_of(group: Group) -> str:
    """The label, and of how many runs it is."""
    done, count = len(group.done), len(group.runs)
    return f"{group.label} ({counted(count, 'run') if done == count else f'{done} of {count} done'})"


def draw_page(groups: Sequence[Group], band: Band, path: Path) -> None:
    """The same to zoom in, above the table: HTML with all that it needs. Raises OSError as `draw_png`."""
    title = escape(groups[0].runs[0].env_id)
    head = "".join(f"<th>{escape(text)}</th>" for text in header(band))
    rows = ["".join(f"<td>{escape(text)}</td>" for text in table_row(group, band)) for group in groups]
    body = "".join(f"<tr>{row}</tr>\n" for row in rows)
    write_text(
        path,
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{_STYLE}</style></head>\n<body><h1>{title}</h1><p>{escape(explanation(groups, band))}</p>\n"
        f"{_plot(groups, band)}\n<table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table>"
        f"<p>{escape(notes(groups, band))}</p></body></html>\n",
    )


def _plot(groups: Sequence[Group], band: Band) -> str:
    from plotly.subplots import make_subplots

    figure = make_subplots(1, 2, shared_yaxes=True, horizontal_spacing=0.04)
    for column, along in enumerate(AXES, start=1):
        for group, colour in zip(groups, cycle(PALETTE), strict=False):
            figure.add_traces(_traces(group, along, band, colour), rows=1, cols=column)
        figure.update_xaxes(title_text=AXES[along], range=[0, _reach(groups, along)], row=1, col=column)
    figure.update_xaxes(zeroline=False, linecolor=_MUTED, ticks="outside", tickcolor=_MUTED)
    figure.update_yaxes(zeroline=False, range=[-0.02, 1.04], tickformat=".0%", hoverformat=".1%")
    figure.update_yaxes(title_text="success", row=1, col=1)
    figure.update_layout(
        height=440 + 26 * _legend_size(groups)[1], template="plotly_white", margin={"t": 20, "b": 50, "l": 60, "r": 20},
        hovermode="closest", legend={"orientation": "h", "yref": "container", "y": 0, "yanchor": "bottom"},
    )  # fmt: skip
    return figure.to_html(full_html=False, include_plotlyjs=True, config={"displaylogo": False})


def _traces(group: Group, along: Along, band: Band, colour: str) -> list[Any]:
    """A band, single runs, and the mean; one name in the legend shows and hides all of both panels."""
    from plotly.graph_objects import Scatter

    x, curves = group.curves(along)
    shared = {"legendgroup": group.label, "mode": "lines", "line": {"color": colour, "width": 1}}
    silent = {"showlegend": False, "hoverinfo": "skip"}
    drawn: list[Any] = []
    if len(curves) > 1:
        low, high = interval(curves, band)
        around, limits = np.concatenate([x, x[::-1]]), np.concatenate([high, low[::-1]])
        filled = {"fill": "toself", "fillcolor": colour, "opacity": 0.25, "line": {"width": 0}}
        drawn.append(Scatter(x=around, y=limits, **shared | silent | filled))
    if len(group.runs) > 1:
        for run, places, success in group.single(along):
            thin = shared | {"line": {"color": colour, "width": 1, "dash": "solid" if run.is_done else "dash"}}
            name = f"seed {run.seed}{'' if run.is_done else ', stopped'}"
            drawn.append(Scatter(x=places, y=success, opacity=0.45, name=name, showlegend=False, **thin))
    mean, wide = curves.mean(axis=0), shared | {"line": {"color": colour, "width": 3}}
    drawn.append(Scatter(x=x, y=mean, name=name_of(group), showlegend=along == "steps", **wide))
    end = {"mode": "markers", "marker": {"color": colour, "size": 9}}
    drawn.append(Scatter(x=x[-1:], y=mean[-1:], **shared | silent | end))
    return drawn
