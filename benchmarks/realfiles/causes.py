"""Why files fail, told so that alike ones count together."""

from collections import defaultdict
from collections.abc import Iterable

from benchmarks.realfiles.results import COLUMNS, Result, reasons
from benchmarks.realfiles.wording import alike

OVERLAP = 1e-3  # [m]
# What a file may ask for that has to do with a column.
FORCES = ("joint springs", "tendons", "fluid", "gravcomp", "activations", "actuator on ", "plugins", "flex", "no ")
CONSTRAINTS = ("equality ", "mocap", "tendon limits", "ball limits", "height field", "margin", "flex", "no ")


def cause(result: Result, column: str, reason: str) -> str:
    """What to look for: the message of what is refused, the kinds of statics that differ, else what the file asks."""
    if result["ended"] == reason:
        return reason
    if column == "loads":
        return alike(reason)
    if column == "statics":
        return ", ".join(sorted(part.split(":")[0] for part in reason.split("; ")))
    if column == "accelerations":
        return "statics differ" if any(result["statics"].values()) else asks(result, FORCES)
    if column == "stable":
        how = "SimulationError" if "SimulationError" in reason else "runs away"
        return f"{how}; {asks(result, CONSTRAINTS)}; {overlap(result)}"
    return asks(result, FORCES + CONSTRAINTS)


def asks(result: Result, kinds: tuple[str, ...]) -> str:
    """Those of these that the file has."""
    found = [name for name in result["features"] if name.startswith(kinds)]
    return ", ".join(found) or "nothing particular"


def overlap(result: Result) -> str:
    """How deep geoms lie in each other at the start, in MuJoCo."""
    depth = result["overlap"]
    return "overlap at the start" if depth > OVERLAP else "touching at the start" if depth > 0 else "nothing touches"


def by_cause(results: Iterable[Result]) -> dict[str, dict[str, list[str]]]:
    """Files by column and cause, the most frequent cause first."""
    found: dict[str, dict[str, list[str]]] = {column: defaultdict(list) for column in COLUMNS}
    for result in results:
        for column, reason in reasons(result).items():
            found[column][cause(result, column, reason)].append(result["file"])
    return {
        column: dict(sorted(causes.items(), key=lambda item: (-len(item[1]), item[0])))
        for column, causes in found.items()
    }
