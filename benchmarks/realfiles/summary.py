"""The tables at the end: by collection, by cause, and what a step costs."""

from collections import Counter
from collections.abc import Sequence
from statistics import median
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.realfiles.causes import by_cause
from benchmarks.realfiles.results import COLUMNS, FAIL, PASS, Result, accepted, verdicts

CONTACTS = ((0, 0.5, "none"), (0.5, 10.5, "1 to 10"), (10.5, 40.5, "11 to 40"), (40.5, 1e9, "more"))
SHOWN = 4  # files of a cause


def figures(results: Sequence[Result]) -> dict[str, Any]:
    """All that the tables show, for programs."""
    scenes = [result for result in results if accepted(result)]
    collections = {name: [r for r in scenes if r["collection"] == name] for name in names(results)}
    return {
        "files": len(results),
        "accepted": len(scenes),
        "collections": {name: counts(group) for name, group in collections.items()} | {"all": counts(scenes)},
        "causes": by_cause(scenes),
        "cost": cost(scenes),
    }


def names(results: Sequence[Result]) -> list[str]:
    """Of collections, in their order."""
    return list(dict.fromkeys(result["collection"] for result in results))


def counts(results: Sequence[Result]) -> dict[str, Any]:
    """How many pass, of how many to which the column applies."""
    found = Counter((column, word) for result in results for column, word in verdicts(result).items())
    columns = {c: [found[c, PASS], found[c, PASS] + found[c, FAIL]] for c in COLUMNS}
    return {"accepted": len(results), "serious": sum(bool(result.get("serious")) for result in results)} | columns


def cost(results: Sequence[Result]) -> dict[str, dict[str, Any]]:
    """Our processor time a step by MuJoCo's, by the number of MuJoCo's contacts, over runs that hold."""
    runs = [(r["file"], run) for r in results for run in r["motion"] if not run["exploded"] and not run["unstable"]]
    timed = [(f, run["contacts"], run["cost"] / run["their_cost"]) for f, run in runs if run["their_cost"] > 0]
    found: dict[str, dict[str, Any]] = {}
    for lower, upper, name in (*CONTACTS, (0, 1e9, "all")):
        here = sorted((ratio, file) for file, contacts, ratio in timed if lower <= contacts < upper)
        if here:
            ratios = [ratio for ratio, _ in here]
            found[name] = {"runs": len(here), "median": median(ratios), "slower": sum(r > 1 for r in ratios)}
            found[name] |= {"worst": round(here[-1][0], 2), "file": here[-1][1]}
    return found


def show(console: Console, results: Sequence[Result]) -> None:
    """Prints the tables."""
    all_figures = figures(results)
    table = Table("collection", "MuJoCo loads", *COLUMNS, "serious", title="Files that hold, of those that apply")
    for name, row in all_figures["collections"].items():
        cells = ["{} / {}".format(*row[column]) if row[column][1] else "-" for column in COLUMNS]
        table.add_row(name, str(row["accepted"]), *cells, str(row["serious"]))
    console.print(table)
    for column, causes in all_figures["causes"].items():
        if not causes:
            continue
        table = Table("files", "cause", "such as", title=f"{column}: why not")
        for cause, files in causes.items():
            more = f", {len(files) - SHOWN} more" if len(files) > SHOWN else ""
            table.add_row(str(len(files)), cause, ", ".join(files[:SHOWN]) + more)
        console.print(table)
    table = Table("contacts", "runs", "median", "slower", "worst", "file", title="Processor time a step / MuJoCo's")
    for name, row in all_figures["cost"].items():
        table.add_row(
            name, str(row["runs"]), f"{row['median']:.2f}", str(row["slower"]), str(row["worst"]), row["file"]
        )
    console.print(table)
