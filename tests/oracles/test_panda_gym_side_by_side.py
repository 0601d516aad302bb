"""The native environments side by side with panda-gym 3.0.7: few seeds; benchmarks/beside_panda_gym.py runs many."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

pytest.importorskip("panda_gym")

from benchmarks import beside_panda_gym as beside

SEEDS = range(100, 112)
LOOSE = 2.0  # medians of so few episodes scatter


@pytest.mark.parametrize("case", beside.REPLAYS, ids=lambda case: f"{case.task}, {case.name}")
def test_the_same_actions_lead_to_the_same_places(case: beside.Replay, capsys: pytest.CaptureFixture[str]) -> None:
    found = beside.replay(case, SEEDS)
    with capsys.disabled():
        end = "" if found.object is None else f", object in the end {1000 * found.object:.1f} mm"
        print(f"\n  {case.task}, {case.name}: hand {1000 * found.hand:.2f} mm{end} in the median", end="")
    for value, wanted in (
        (found.free, case.wanted_free),
        (found.hand, case.wanted_hand),
        (found.object, case.wanted_object),
    ):
        assert wanted is None or (value is not None and value <= LOOSE * wanted)


@pytest.mark.parametrize("task", beside.TASKS)
def test_the_expert_does_as_well_there_as_here(task: str) -> None:
    rates = beside.success_rates(task, beside.expert, SEEDS)
    # Three failures of twelve apart are more than chance where both succeed nearly always.
    assert rates.ours == pytest.approx(rates.theirs, abs=3.5 / len(SEEDS))
    assert rates.theirs > 0.6


def test_what_is_compared_is_not_one_environment_twice() -> None:
    case = next(case for case in beside.REPLAYS if case.name == "slide")
    with beside.panda_gym("Slide") as env:
        theirs = beside.recorded(env, beside.reset(env, "Slide", 1), case.policy("Slide", 1), 50)
    ours = beside.ours_of("Slide", 1, lambda _, t: theirs.actions[t], 50)
    assert not np.array_equal(ours.rows, theirs.rows)
    assert np.linalg.norm(theirs.object_end("Slide") - theirs.rows[0, 6:9]) > 0.2, "the puck is hit"
