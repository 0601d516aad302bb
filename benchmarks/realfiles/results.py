"""What is known of a file, a line of JSON each, and what it means."""

import hashlib
from pathlib import Path

from benchmarks import lines
from benchmarks.children import Ended
from benchmarks.lines import Result, append, ending, write
from benchmarks.realfiles.accelerations import TOLERANCE
from benchmarks.realfiles.examine import Task

__all__ = ["COLUMNS", "Result", "append", "key_of", "read", "reasons", "result_of", "verdicts", "write"]
MEASURING = ("examine", "loading", "statics", "accelerations", "motion", "../mujoco_map")
COLUMNS = ("loads", "statics", "accelerations", "stable", "rests")
PASS, FAIL, NONE = "pass", "fail", "-"


def result_of(ended: Ended[Task], key: str) -> Result:
    """All that a child has told, and how it ended."""
    result: Result = {"file": ended.task.file.name, "collection": ended.task.file.collection, "key": key, "motion": []}
    for said in ended.said:
        if "run" in said:
            result["motion"].append(said["run"])
        else:
            result |= said
    result["ended"] = ending(ended.status)
    return result


def accepted(result: Result) -> bool:
    """Whether MuJoCo loads the file: the others are fragments, or need what is not in the wheel."""
    return result.get("mujoco") == ""


def reasons(result: Result) -> dict[str, str]:
    """Why columns fail; columns that hold, or do not apply, are left out."""
    if not accepted(result):
        return {}
    found: dict[str, str] = {}
    load, ended = result.get("load"), result["ended"]
    where = {"load": "loads", "statics": "statics", "accelerations": "accelerations", "motion": "stable"}
    if ended and result.get("stage") in where:
        found[where[result["stage"]]] = ended
    if load and load["refused"]:
        found["loads"] = load["refused"]
    differing = [f"{kind}: {text}" for kind, text in result.get("statics", {}).items() if text]
    if differing:
        found["statics"] = "; ".join(differing)
    rates = result.get("accelerations")
    if rates and (rates["error"] or rates["away"] > TOLERANCE) and not result["serious"]:
        found["accelerations"] = rates["error"] or f"{rates['away']:.1e} at {rates['where']}"
    for run in result["motion"]:
        for column, kind in (("stable", "verdict"), ("rests", "restless")):
            if run[kind] and not (column == "rests" and result["serious"]):
                found.setdefault(column, f"{run['start']}: {run[kind]}")
    return found


def verdicts(result: Result) -> dict[str, str]:
    """PASS, FAIL or NONE for each of COLUMNS."""
    failing = reasons(result)
    known = {
        "loads": accepted(result),
        "statics": bool(result.get("statics")),
        "accelerations": bool(result.get("accelerations", {}).get("states")) and not result.get("serious"),
        "stable": any(not run["unstable"] for run in result["motion"]),
        "rests": any(run["rests"] for run in result["motion"]) and not result.get("serious"),
    }
    return {name: FAIL if name in failing else PASS if known[name] else NONE for name in COLUMNS}


def key_of(package: Path, seconds: float) -> str:
    """Of what results depend on: the engine that made them, and how long motions last."""
    here, digest = Path(__file__).parent, hashlib.sha256()
    for path in [*sorted(package.glob("*.so")), *(here / f"{name}.py" for name in MEASURING)]:
        digest.update(path.read_bytes())
    return f"{digest.hexdigest()[:16]}, {seconds:g} s"


def read(path: Path, key: str | None = None) -> dict[str, Result]:
    """Results by file."""
    return lines.read(path, "file", key)
