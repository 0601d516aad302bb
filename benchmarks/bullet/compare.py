"""What the two sides of a program say together."""

from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.bullet.programs import ENVIRONMENT, Program
from benchmarks.bullet.trial import BULLET, HERE, Outcome, Result

FAR = 20.0  # times as far from the origin as in Bullet, and
AWAY = 50.0  # metres, is flown away
IDLE = "does nothing with PyBullet"


@dataclass
class Row:
    """A line of the table. `bullet`, `here`: "runs", "fails" or "idle"; `why`: of the column that does not run."""

    name: str
    kind: str
    bullet: str
    here: str
    why: str

    @property
    def counts(self) -> bool:
        """Whether it is one of those by which this engine is judged."""
        return self.bullet == "runs"

    @property
    def passes(self) -> bool:
        return self.counts and self.here == "runs"


def row_of(program: Program, result: Result) -> Row:
    """A program's line."""
    bullet, here = result[BULLET], result[HERE]
    words = word(bullet), word(here)
    if words[0] == "fails":
        start = "not on Bullet either" if words[1] == "fails" else "in Bullet"
        return Row(program.name, program.kind, *words, f"{start}: {bullet.why}")
    if words[0] == "idle":
        return Row(program.name, program.kind, *words, here.why or IDLE)
    return Row(program.name, program.kind, *words, here.why or remark(program, bullet, here))


def word(outcome: Outcome) -> str:
    """Whether it runs, and calls PyBullet at all."""
    if not outcome.runs:
        return "fails"
    return "runs" if outcome.calls else "idle"


def remark(program: Program, bullet: Outcome, here: Outcome) -> str:
    """What differs where both run."""
    if program.kind == ENVIRONMENT:
        if "reward" not in bullet.told or "reward" not in here.told:
            return "at work when its time was over"
        return f"reward {bullet.told['reward']:.4g} in Bullet, {here.told['reward']:.4g} here"
    looks = bullet.told["looks"], here.told["looks"]
    common = [step for step in looks[0] if step in looks[1]]
    if not common:
        return ""
    theirs, ours = (look[common[-1]] for look in looks)
    if theirs["reach"] is not None and ours["reach"] > max(AWAY, FAR * theirs["reach"]):
        return f"after {common[-1]} steps a body is {ours['reach']:.0f} m away, {theirs['reach']:.0f} m in Bullet"
    if theirs["bodies"] != ours["bodies"]:
        return f"after {common[-1]} steps there are {ours['bodies']} bodies, {theirs['bodies']} in Bullet"
    return ""


def record(row: Row, result: Result) -> dict[str, Any]:
    """All that is known, for programs."""
    sides = {side: {"word": getattr(row, side), **asdict(outcome)} for side, outcome in result.items()}
    return {"name": row.name, "kind": row.kind, "why": row.why, **sides}
