"""A measured figure, and how several programs are measured in turns."""

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

NOISY = 0.10  # a larger variation makes a figure doubtful


@dataclass
class Row:
    """One line of the table and of build/bench.json."""

    benchmark: str
    engine: str
    number_type: str
    threads: int
    value: float | None  # None: not measured, `note` says why
    unit: str
    ratio: float | None = None  # how many times faster than `ratio_to`
    ratio_to: str = ""
    variation: float | None = None  # between rounds: standard deviation / mean
    target: str = ""
    verdict: str = ""  # "pass" or "short"
    note: str = ""
    wrong: bool = False  # the result was not what it must be: the figure counts for nothing

    def refuse(self, why: str) -> None:
        """Takes the figure back: its result was wrong."""
        self.value, self.ratio, self.note, self.wrong = None, None, f"REFUSED: {why}", True


@dataclass
class Contender:
    """A program that is measured: `run(n)` does n calls of `units` pieces of work each."""

    row: Row
    run: Callable[[int], None]
    units: int = 1
    calls: int = 0  # of one round; 0: found out
    clock: Callable[[], float] = time.perf_counter  # [s], or time.thread_time: what it costs, whoever else is running
    rates: list[float] = field(default_factory=list)  # (rounds) units per second

    @property
    def total_calls(self) -> int:
        """In the rounds so far."""
        return self.calls * len(self.rates)


def calibrate(contender: Contender, seconds: float) -> None:
    """Sets the number of calls such that a round takes about `seconds`. The calls made here do not count."""
    calls = 1
    while True:
        start = time.perf_counter()
        contender.run(calls)
        spent = time.perf_counter() - start
        if spent >= 0.2 * seconds:
            contender.calls = max(1, round(calls * seconds / spent))
            return
        calls *= 2


def measure_in_turns(contenders: Sequence[Contender], rounds: int, seconds: float) -> None:
    """Runs all contenders once a round, so that a disturbance of the machine meets them alike; fills their rows."""
    for contender in contenders:
        if contender.calls == 0:
            calibrate(contender, seconds)
    for _ in range(rounds):
        for contender in contenders:
            start = contender.clock()
            contender.run(contender.calls)
            contender.rates.append(contender.calls * contender.units / (contender.clock() - start))
    for contender in contenders:
        contender.row.value = statistics.median(contender.rates)
        contender.row.variation = variation(contender.rates)


def variation(values: Sequence[float]) -> float:
    """Standard deviation / mean of the middle three fifths."""
    cut = len(values) // 5
    middle = sorted(values)[cut : len(values) - cut]
    return statistics.pstdev(middle) / statistics.fmean(middle)
