"""One scene: run, and looked at from outside."""

import re
import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

import manyhands as mh
from benchmarks.absurd import lanes
from benchmarks.absurd.energy import Ledger
from benchmarks.absurd.families import family_of, setting_of
from benchmarks.absurd.setting import Setting

STEPS, MIDDLE, REPEATED = 300, 150, 20
MOST_SECONDS = 2.0  # of the processor, for a step
MOST_ENERGY = 20.0  # times what there can be: a step is refused once it doubles it, and some pass before that
HELD, ERROR, REFUSED, FAILED, FLAGGED = "held", "error", "refused", "failed", "flagged"
NAMED = re.compile(r"'([^']*)'")
TIME = re.compile(r"at [-+0-9.e]+ s")


@dataclass
class Outcome:
    """What came of a scene."""

    number: int
    family: str
    outcome: str = HELD
    reason: str = ""  # of an error or a failure
    steps: int = 0
    dofs: int = 0
    contacts: int = 0  # most
    ratio: float = 0.0
    energy: str = ""  # where the ratio is largest
    slowest: float = 0.0  # [s] a step, of the processor
    total: float = 0.0
    lanes: str = ""  # what became of it in single precision, if it was run
    lanes_ratio: float = 0.0

    def fail(self, reason: str) -> None:
        """The first reason counts."""
        if self.outcome != FAILED:
            self.outcome, self.reason = FAILED, reason

    def words(self) -> dict[str, Any]:
        """For a line of JSON."""
        return asdict(self)


def run(seed: int, number: int, steps: int = STEPS, in_lanes: bool = False) -> Outcome:
    """The scene of that number, in single precision too if asked for."""
    outcome = Outcome(number, family_of(number))
    setting = setting_of(seed, number)
    try:
        world = setting.build()
    except ValueError as why:
        outcome.outcome, outcome.reason = REFUSED, first_line(why)
        return outcome
    outcome.dofs = world.model.nv
    if not world.model.nv:
        return outcome
    start = world.copy()
    try:
        advance(setting, world, steps, outcome)
    except mh.SimulationError as why:
        judge_error(str(why), world, outcome)
    if in_lanes:
        outcome.lanes, outcome.lanes_ratio = lanes.run(setting, start, steps)
        if outcome.lanes not in (HELD, FLAGGED):
            outcome.fail(f"in lanes: {outcome.lanes}")
    return outcome


def first_line(why: Exception) -> str:
    """Of its message."""
    return f"{type(why).__name__}: {why}".splitlines()[0][:300]


def advance(setting: Setting, world: mh.World, steps: int, outcome: Outcome) -> None:
    """All steps, with a look after each; in the middle some are repeated."""
    ledger = Ledger(setting, world)
    saved, hashed = b"", 0
    for step in range(steps):
        if step == MIDDLE:
            saved = world.snapshot()
        jump(setting, world, step)
        before = (world.q, world.v)
        begun = time.thread_time()
        try:
            world.step()
        except mh.SimulationError:
            if not all(np.array_equal(a, b) for a, b in zip(before, (world.q, world.v), strict=True)):
                outcome.fail("an error left the world otherwise than before the step")
            raise
        finally:
            took = time.thread_time() - begun
            outcome.slowest, outcome.total = max(outcome.slowest, took), outcome.total + took
        outcome.steps += 1
        look(world, ledger, outcome)
        if outcome.outcome == FAILED:
            return
        if step == MIDDLE + REPEATED - 1:
            hashed = world.state_hash()
            again = world.copy()
            again.restore(saved)
            for k in range(MIDDLE, MIDDLE + REPEATED):
                jump(setting, again, k)
                again.step()
            if again.state_hash() != hashed:
                outcome.fail("a snapshot went on otherwise")


def jump(setting: Setting, world: mh.World, step: int) -> None:
    """Mocap bodies that move now."""
    for one in setting.jumps_at(step):
        world.set_mocap(one.body, one.position, one.quaternion)


def look(world: mh.World, ledger: Ledger, outcome: Outcome) -> None:
    """After a step."""
    outcome.contacts = max(outcome.contacts, len(world.contacts()))
    if not (np.isfinite(world.q).all() and np.isfinite(world.v).all()):
        outcome.fail("a state that is not finite")
        return
    ledger.see(world)
    outcome.ratio, outcome.energy = ledger.ratio, ledger.last
    if not ledger.ratio <= MOST_ENERGY:
        outcome.fail("energy from nowhere")
    if outcome.slowest > MOST_SECONDS:
        outcome.fail("a step without end")


def judge_error(message: str, world: mh.World, outcome: Outcome) -> None:
    """An error is an answer if it says what, when and why."""
    if outcome.outcome == FAILED:
        return
    outcome.outcome, outcome.reason = ERROR, message
    model = world.model
    known = {part.name for parts in (model.joints, model.links, model.geoms, model.tendons) for part in parts}
    if not known.intersection(NAMED.findall(message)):
        outcome.fail(f"an error without a name: {message}")
    elif not TIME.search(message):
        outcome.fail(f"an error without a time: {message}")
