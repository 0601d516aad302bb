"""The page of the documentation: a table of all programs."""

from collections.abc import Sequence

from benchmarks.bullet.compare import Row
from benchmarks.bullet.programs import ENVIRONMENT, SCRIPT

HEAD = """\
# PyBullet's own examples

```
python -m benchmarks.bullet examples --table docs/pybullet_examples.md    # all: writes this page
python -m benchmarks.bullet examples --only kuka                          # those whose names hold this
```

Every script of the wheel of PyBullet 3.2.7 that does something when run, and every environment that pybullet_envs
registers in gym, runs in a process of its own, first on PyBullet and then on `manyhands.pybullet`. Nobody sits before
them: connections with a window have none, sliders keep their values, `sleep` returns at once, `input` gives an empty
line, and real-time simulation makes the steps that are due at the next call. The old gym is `manyhands.gym` on both
sides. `benchmarks/bullet/extras.py` lists what is installed for them below `build/`.

A script *runs* if it ends without an error, or is still calling PyBullet after {seconds:g} seconds of processor time;
an environment if it is made, reset, and takes 50 random actions with finite observations and rewards. *idle*: it ends
without a call of PyBullet, and counts nowhere.

**{passed} of the {counted} programs that run on PyBullet run here, {share:.1%}.**
"""
TITLES = {SCRIPT: "## Scripts that run on PyBullet", ENVIRONMENT: "## Environments, under random actions"}
REST = "## Scripts that do not run on PyBullet, or do nothing with it"


def page(rows: Sequence[Row], seconds: float) -> str:
    """All of it as Markdown."""
    counted = [row for row in rows if row.counts]
    passed = sum(row.passes for row in rows)
    share = passed / len(counted) if counted else 0.0
    parts = [HEAD.format(seconds=seconds, passed=passed, counted=len(counted), share=share)]
    for kind, title in TITLES.items():
        parts.append(section(title, [row for row in rows if row.kind == kind and (row.counts or kind == ENVIRONMENT)]))
    parts.append(section(REST, [row for row in rows if row.kind == SCRIPT and not row.counts]))
    return "\n".join(part for part in parts if part)


def section(title: str, rows: Sequence[Row]) -> str:
    """One table; nothing without rows."""
    if not rows:
        return ""
    lines = [f"| {row.name} | {row.bullet} | {row.here} | {cell(row.why)} |" for row in rows]
    return "\n".join([title, "", "| program | Bullet | here | why |", "| --- | --- | --- | --- |", *lines, ""])


def cell(text: str) -> str:
    """Text that does not end a cell, or look like markup."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")
