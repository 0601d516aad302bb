"""The tables at the end."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from benchmarks.absurd.run import ERROR, FAILED, FLAGGED, HELD, REFUSED
from benchmarks.lines import Result
from benchmarks.realfiles.wording import alike

SHOWN = 8  # scenes of a cause


def figures(results: Sequence[Result]) -> dict[str, Any]:
    """All that the tables show, for programs."""
    names = list(dict.fromkeys(result["family"] for result in sorted(results, key=lambda r: r["number"])))
    families = {name: [r for r in results if r["family"] == name] for name in names}
    return {
        "families": {name: row(group) for name, group in families.items()} | {"all": row(results)},
        "causes": {kind: causes([r for r in results if r["outcome"] == kind]) for kind in (ERROR, REFUSED, FAILED)},
    }


def row(results: Sequence[Result]) -> dict[str, Any]:
    """Of a family."""
    counts = Counter(result["outcome"] for result in results)
    lanes = Counter(result["lanes"] for result in results if result["lanes"])
    sound = [result for result in results if result["outcome"] != FAILED]
    return {
        "scenes": len(results),
        **{kind: counts[kind] for kind in (HELD, ERROR, REFUSED, FAILED)},
        "ratio": max((result["ratio"] for result in sound), default=0.0),
        "slowest": max((result["slowest"] for result in results), default=0.0),
        "in lanes": sum(lanes.values()),
        "lanes held": lanes[HELD],
        "lanes flagged": lanes[FLAGGED],
    }


def causes(results: Sequence[Result]) -> dict[str, list[int]]:
    """Numbers of scenes by reason, the most frequent first."""
    found: dict[str, list[int]] = {}
    for result in results:
        found.setdefault(cause(result["reason"]), []).append(result["number"])
    return dict(sorted(found.items(), key=lambda item: (-len(item[1]), item[0])))


def cause(reason: str) -> str:
    """What an error says, without what is a scene's own."""
    if "from nothing" in reason:
        return "a step moves things too far to follow"
    if "not finite" in reason:
        return "numbers that are not finite"
    return alike(reason)[:100]


def show(console: Console, results: Sequence[Result]) -> None:
    """Prints the tables."""
    found = figures(results)
    heads = ("family", "scenes", HELD, ERROR, REFUSED, FAILED, "energy", "slowest step", "in lanes", HELD, FLAGGED)
    table = Table(*heads, title="Absurd scenes")
    for name, r in found["families"].items():
        cells = [
            r["scenes"],
            r[HELD],
            r[ERROR],
            r[REFUSED],
            r[FAILED],
            f"{r['ratio']:.2g}",
            f"{r['slowest'] * 1e3:.0f} ms",
        ]
        cells += [r["in lanes"], r["lanes held"], r["lanes flagged"]]
        table.add_row(name, *map(str, cells))
    console.print(table)
    for kind, reasons in found["causes"].items():
        for reason, numbers in reasons.items():
            more = f" and {len(numbers) - SHOWN} more" if len(numbers) > SHOWN else ""
            some = ", ".join(map(str, numbers[:SHOWN]))
            console.print(f"{kind}: {len(numbers)}: {reason} (scenes {some}{more})", highlight=False, markup=False)
