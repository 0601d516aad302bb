"""`python -m benchmarks.bullet files`: every file of pybullet_data in both modules, as docs/pybullet_files.md.

Each file is loaded in a process of its own, for some end the real module's.
"""

import os
import pickle
import tempfile
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.bullet.reasons import REASONS

ROOT = Path(__file__).parents[2]
TABLE = ROOT / "docs/pybullet_files.md"
LOADERS = {".urdf": "loadURDF", ".sdf": "loadSDF", ".xml": "loadMJCF"}
NEAR = 1e-4
"""[m, rad, kg relative]: Bullet's numbers went through 32 bits."""

HEAD = """\
# PyBullet's files

Every URDF, SDF and MJCF file of the real `pybullet_data` folder, loaded by real PyBullet 3.2.7 and by
`manyhands.pybullet`: names, types, parents and limits of joints, masses, and the poses of bases and links, within
{near}. A range whose ends are the wrong way round is none. `random_urdfs` holds a thousand objects of one kind: every
hundredth is here. `python -m benchmarks.bullet files` writes this table.

{count}

| file | | |
| --- | --- | --- |
"""


@dataclass
class Told:
    """What a module tells of a file: its bodies, or why it has none."""

    bodies: list[dict[str, Any]] = field(default_factory=list)
    error: str = ""


def data_files(root: Path) -> list[str]:
    """Paths in the folder; of the thousand random objects every hundredth."""
    found = sorted(str(path.relative_to(root)) for kind in LOADERS for path in root.rglob(f"*{kind}"))
    usual = [path for path in found if not path.startswith("random_urdfs")]
    return usual + [path for path in found if path.startswith("random_urdfs") and path[13:16].endswith("00")]


def told_in_a_child(module: Any, path: Path) -> Told:
    """What the module tells; "the process ends" if it does."""
    reading, writing = os.pipe()
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            os.dup2(printed.fileno(), 1)
            os.dup2(printed.fileno(), 2)
            result = told(module, path)
            with os.fdopen(writing, "wb") as stream:
                stream.write(pickle.dumps(result))
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as stream:
            data = stream.read()
        os.waitpid(child, 0)
        result = pickle.loads(data) if data else Told(error="the process ends")
        if result.error:
            printed.seek(0)
            result.error += reason_in(printed.read().decode(errors="replace"))
    return result


def reason_in(printed: str) -> str:
    """The last warning, without the place in Bullet's sources."""
    lines = [line.split("]:")[-1].removeprefix("b3Warning:").strip() for line in printed.splitlines()]
    lines = [line for line in lines if line and "b3Warning" not in line and "No inertial data" not in line]
    return f" ({lines[-1]})" if lines else ""


def told(module: Any, path: Path) -> Told:
    """What the module tells of a file."""
    client = module.connect(module.DIRECT)
    try:
        loaded = getattr(module, LOADERS[path.suffix])(str(path), physicsClientId=client)
    except module.error as error:
        return Told(error=str(error))
    ids = loaded if isinstance(loaded, tuple) else (loaded,)
    return Told([body(module, one, client) for one in ids])


def body(module: Any, one: int, client: int) -> dict[str, Any]:
    """All that is compared of a body, by what it is called in the table."""
    links = range(module.getNumJoints(one, physicsClientId=client))
    joints = [module.getJointInfo(one, i, physicsClientId=client) for i in links]
    states = [module.getLinkState(one, i, physicsClientId=client) for i in links]
    dynamics = [module.getDynamicsInfo(one, i, physicsClientId=client) for i in (-1, *links)]
    return {
        "names": [module.getBodyInfo(one, physicsClientId=client)[0], *((info[1], info[12]) for info in joints)],
        "types and parents of joints": [(info[2], info[3], info[4], info[16]) for info in joints],
        "limits": [(info[8:10] if info[8] <= info[9] else "none", info[10:12]) for info in joints],
        "masses": [info[0] for info in dynamics],
        "place of the base": module.getBasePositionAndOrientation(one, physicsClientId=client),
        "centres of mass": [info[3] for info in dynamics],
        "poses of links": [state[4:6] for state in states],
    }


def differences(ours: Told, theirs: Told) -> list[str]:
    """What of the bodies is not the same."""
    if len(ours.bodies) != len(theirs.bodies):
        return [f"{len(ours.bodies)} bodies, not {len(theirs.bodies)}"]
    counts = [(len(a["masses"]), len(b["masses"])) for a, b in zip(ours.bodies, theirs.bodies, strict=True)]
    if any(a != b for a, b in counts):
        return ["the number of links"]
    found = Counter(
        what for a, b in zip(ours.bodies, theirs.bodies, strict=True) for what in a if not alike(a[what], b[what])
    )
    return list(found)


def alike(a: Any, b: Any) -> bool:
    """Whether the two are the same, numbers nearly, quaternions up to their sign."""
    if isinstance(a, tuple | list):
        if len(a) != len(b):
            return False
        if len(a) == 4 and all(isinstance(x, float) for x in a) and sum(x * y for x, y in zip(a, b, strict=True)) < 0:
            a = [-x for x in a]
        return all(alike(x, y) for x, y in zip(a, b, strict=True))
    return abs(a - b) <= NEAR * max(1.0, abs(b)) if isinstance(a, float) else a == b


def judged(ours: Told, theirs: Told) -> tuple[str, str]:
    """The verdict on a file, and what there is to say."""
    if ours.error and theirs.error:
        return "fails in both", f"here: {ours.error}; Bullet: {theirs.error}"
    if ours.error:
        return "fails here", ours.error
    if theirs.error:
        return "loads here", f"Bullet: {theirs.error}"
    found = differences(ours, theirs)
    return ("differs", ", ".join(found)) if found else ("same", "")


def rows(names: Sequence[str] = ()) -> list[tuple[str, str, str]]:
    """File, verdict and words on it."""
    import pybullet
    import pybullet_data

    import manyhands.pybullet as ours

    root = Path(pybullet_data.getDataPath())
    table = []
    for name in names or data_files(root):
        verdict, words = judged(told_in_a_child(ours, root / name), told_in_a_child(pybullet, root / name))
        reason = REASONS.get(name) or next((why for start, why in REASONS.items() if name.startswith(start)), "")
        words = words.replace(f"{root}/", "").replace("|", "/")
        table.append((name, verdict, words + (f": {reason}" if reason and verdict != "same" else "")))
        print(*table[-1], sep=" | ", flush=True)
    return table


def main(names: Sequence[str] = ()) -> int:
    """Writes the table; the exit status is 1 if a file fails here alone, or differs and nobody has said why."""
    found = rows(names)
    counts = Counter(verdict for _, verdict, _ in found)
    count = f"**{len(found)} files: " + ", ".join(f"{n} {verdict}" for verdict, n in counts.most_common()) + ".**"
    if not names:
        lines = "".join(f"| `{name}` | {verdict} | {words} |\n" for name, verdict, words in found)
        TABLE.write_text(HEAD.format(near=NEAR, count=count) + lines, encoding="utf-8")
        print(f"Written: {TABLE}")
    print(count)
    return int(any(verdict in ("differs", "fails here") and name not in REASONS for name, verdict, _ in found))
