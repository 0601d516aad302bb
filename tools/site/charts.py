"""Charts of accuracy and speed: from the rows of the last runs if there are any, else from the tables of the docs."""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

COLOURS = {"manyhands": "#1f9e89", "manyhands lanes": "#7ccba2", "MuJoCo": "#e08e45", "PyBullet": "#8c6bb1",
           "panda-gym": "#8c6bb1", "Pinocchio": "#e08e45", "TinyRenderer": "#8c6bb1"}  # fmt: skip
GREY = "#808890"  # legible on light and on dark pages
FLOOR, CEILING = 1e-9, 1e6  # errors beyond are drawn there
NUMBER = re.compile(r"[-+]?\d[\d,]*\.?\d*(?:e[-+]?\d+)?")


@dataclass
class Figure:
    """One figure of several engines: an error and its bound, or a rate."""

    name: str
    unit: str = ""
    bound: float | None = None
    values: dict[str, float] = field(default_factory=dict)


def write_charts(root: Path, pages: Path) -> None:
    """Draws `images/accuracy.svg` and `images/speed_*.svg`, and tells where the figures are from."""
    images = pages / "images"
    origin = {}
    errors, origin["accuracy"] = accuracy_figures(root)
    draw_errors(errors, images / "chart_accuracy.svg")
    groups, origin["speed"] = speed_figures(root)
    for name, figures in groups.items():
        draw_rates(figures, images / f"chart_{name}.svg")
    for name, told in origin.items():
        (pages / f"{name}_origin.txt").write_text(told)


def tables(file: Path) -> list[list[list[str]]]:
    """The tables of a document: rows of cells."""
    found: list[list[list[str]]] = []
    before = ""
    for line in file.read_text().splitlines():
        if line.startswith("|"):
            if not before.startswith("|"):
                found.append([])
            found[-1].append([cell.strip(" *") for cell in line.strip().strip("|").split("|")])
        before = line
    return found


def table_with(file: Path, *headings: str) -> list[list[str]]:
    """The first table whose first row has these words in it."""
    return next(table for table in tables(file) if all(word in " | ".join(table[0]) for word in headings))


def number(cell: str) -> float | None:
    """The first number of a cell."""
    match = NUMBER.search(cell)
    return float(match[0].replace(",", "")) if match else None


def accuracy_figures(root: Path) -> tuple[list[Figure], str]:
    """Errors with their bounds, engine by engine, and where they are from."""
    file = root / "build/accuracy.json"
    figures: dict[tuple[str, str], Figure] = {}
    if file.is_file():
        rows = json.loads(file.read_text())["rows"]
        for row in rows:
            if row["error"] is None or not row["bound"]:
                continue
            name = (row["case"], row["metric"])
            figure = figures.setdefault(name, Figure(": ".join(name), row["unit"], row["bound"]))
            best = figure.values.get(row["engine"], float("inf"))
            figure.values[row["engine"]] = min(best, row["error"])
        return list(figures.values()), "Drawn from `build/accuracy.json`, the last run of `make accuracy` here."
    table = table_with(root / "docs/accuracy.md", "case", "figure", "must be")
    case = ""
    for cells in table[2:]:
        case = cells[0] or case
        bound = number(cells[2])
        if bound:
            values = {engine: number(cell) for engine, cell in zip(table[0][3:], cells[3:], strict=True)}
            known = {engine: value for engine, value in values.items() if value is not None}
            figures[case, cells[1]] = Figure(f"{case}: {cells[1].split('[')[0].strip()}", "", bound, known)
    return list(figures.values()), "Drawn from the tables of [Accuracy](accuracy.md)."


def speed_figures(root: Path) -> tuple[dict[str, list[Figure]], str]:
    """Groups of rates, and where they are from."""
    page = root / "docs/performance.md"
    tasks = table_with(page, "panda-gym: random", "ours")
    contact = table_with(page, "substeps/s and core", "MuJoCo")
    dynamics = table_with(page, "ns per arm and core", "Pinocchio")
    groups = {
        "environments": [rate(row[0], **{"manyhands": row[2], "panda-gym": row[1]}) for row in tasks[2:]],
        "contact": [rate(row[0], manyhands=row[1], MuJoCo=row[2], PyBullet=row[4]) for row in contact[2:]],
        "dynamics": [rate(row[0], manyhands=row[5], Pinocchio=row[6]) for row in dynamics[2:] if row[6]],
    }
    file = root / "build/bench.json"
    if not file.is_file():
        return groups, "Drawn from the tables of [Performance](performance.md)."
    rows = [row for row in json.loads(file.read_text())["rows"] if row["value"] is not None and row["threads"] == 1]
    for group, figures in groups.items():
        best = min if group == "dynamics" else max  # nanoseconds, or rates
        for figure in figures:
            start = f"{figure.name} random" if group == "environments" else figure.name
            same = [row for row in rows if row["benchmark"].lower().startswith(start.lower())]
            for engine in figure.values:
                if values := [row["value"] for row in same if row["engine"].startswith(engine)]:
                    figure.values[engine] = best(values)
    return groups, "Drawn from `build/bench.json`, the last run of `make bench` here."


def rate(name: str, **cells: str) -> Figure:
    """A row of a table of rates or times."""
    values = {engine: number(cell) for engine, cell in cells.items()}
    return Figure(name, values={engine: value for engine, value in values.items() if value is not None})


def axes(rows: int, height: float) -> Axes:
    """An empty chart that suits light and dark pages."""
    plt.rcParams.update({"svg.fonttype": "none", "font.family": "sans-serif", "svg.hashsalt": "manyhands"})
    _, ax = plt.subplots(figsize=(8, 0.7 + height * rows))
    ax.tick_params(colors=GREY, length=0)
    ax.grid(axis="x", color=GREY, alpha=0.25, linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ax.spines.values():
        side.set_visible(False)
    return ax


def finish(ax: Axes, names: list[str], path: Path) -> None:
    """Names at the rows, a legend, the file."""
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.4, -0.7)
    ax.legend(frameon=False, labelcolor=GREY, loc="lower left", bbox_to_anchor=(-0.02, 1), ncols=5, borderaxespad=0)
    path.parent.mkdir(parents=True, exist_ok=True)
    plt.savefig(path, transparent=True, bbox_inches="tight", metadata={"Date": None})
    plt.close()


def draw_errors(figures: list[Figure], path: Path) -> None:
    """Every error as a multiple of what it must not exceed."""
    ax = axes(len(figures), 0.25)
    ax.set_xscale("log")
    ax.axvline(1, color=GREY, linewidth=1.2)
    ax.axvspan(1, CEILING * 3, color="#d1495b", alpha=0.08)
    for engine in ("PyBullet", "MuJoCo", "manyhands lanes", "manyhands"):
        points = [
            (min(max(figure.values[engine] / figure.bound, FLOOR), CEILING), row)
            for row, figure in enumerate(figures)
            if figure.bound and engine in figure.values
        ]
        ax.scatter(*zip(*points, strict=True), s=42, color=COLOURS[engine], label=engine, alpha=0.9, linewidths=0)
    ax.set_xlim(FLOOR / 3, CEILING * 3)
    ax.set_xlabel("error / bound; right of the line the bound is missed", color=GREY)
    finish(ax, [figure.name for figure in figures], path)


def draw_rates(figures: list[Figure], path: Path) -> None:
    """Bars, engine beside engine."""
    engines = list(dict.fromkeys(engine for figure in figures for engine in figure.values))
    ax = axes(len(figures), 0.2 + 0.16 * len(engines))
    width = 0.8 / len(engines)
    for k, engine in enumerate(engines):
        rows = [row for row, figure in enumerate(figures) if engine in figure.values]
        values = [figures[row].values[engine] for row in rows]
        places = [row + (k - (len(engines) - 1) / 2) * width for row in rows]
        bars = ax.barh(places, values, 0.9 * width, color=COLOURS[engine], label=engine)
        ax.bar_label(bars, [f"{value:,.0f}" for value in values], color=GREY, padding=4, fontsize=8)
    ax.margins(x=0.12)
    finish(ax, [figure.name for figure in figures], path)
