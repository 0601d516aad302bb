"""`make absurd`: a sample of its scenes, and its own logic."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[3]))

import manyhands as mh
from benchmarks import children
from benchmarks.absurd import __main__ as command
from benchmarks.absurd import run, summary
from benchmarks.absurd.energy import Ledger
from benchmarks.absurd.examine import Task
from benchmarks.absurd.families import FAMILIES, family_of, setting_of

SAMPLE, STEPS = 210, 100
KNOWN_TO_FAIL = {25, 32, 71}  # of seed 1: see docs/absurd.md


@pytest.mark.parametrize("family", list(FAMILIES))
def test_a_sample_of_every_family_holds_or_says_why(family: str) -> None:
    numbers = [n for n in range(SAMPLE) if family_of(n) == family]
    outcomes = [run.run(1, n, STEPS, in_lanes=n % 4 == 0) for n in numbers]
    fails = [o for o in outcomes if o.outcome == run.FAILED and o.number not in KNOWN_TO_FAIL]
    failed = [f"{o.number}: {o.reason} {o.energy}" for o in fails]
    assert not failed, f"python -m benchmarks.absurd --seed 1 --scene N: {failed}"
    assert sum(o.outcome == run.REFUSED for o in outcomes) <= len(outcomes) // 3


def test_a_number_is_one_scene() -> None:
    assert setting_of(3, 45).text() == setting_of(3, 45).text() != setting_of(4, 45).text()


def test_energy_from_nowhere_is_found() -> None:
    setting = setting_of(0, 0)
    setting.parts, setting.world, setting.assets = [], ["<body name='a'><freejoint/><geom size='.1'/></body>"], []
    world = setting.build()
    ledger = Ledger(setting, world)
    world.step()
    ledger.see(world)
    assert ledger.ratio < 1.01
    world.v = [0, 0, 0, 100, 0, 0]
    ledger.see(world)
    assert ledger.ratio > run.MOST_ENERGY


def test_errors_need_a_name_and_a_time() -> None:
    world = mh.World()
    world.add_sphere("ball", 0.1)

    def judged(message: str) -> str:
        outcome = run.Outcome(0, "overlap")
        run.judge_error(message, world, outcome)
        return outcome.outcome

    assert judged("the step at 0.1 s is wrong at joint 'ball_free'") == run.ERROR
    assert judged("the step at 0.1 s is wrong") == run.FAILED
    assert judged("wrong at joint 'ball_free'") == run.FAILED


def test_the_scene_in_which_a_child_dies_has_failed() -> None:
    said = [{"began": 4}, run.Outcome(4, family_of(4)).words(), {"began": 5}]
    found = command.outcomes(children.Ended(Task(0, (4, 5, 6), 1.0, 0), said, -11))
    assert [(r["number"], r["outcome"]) for r in found] == [(4, run.HELD), (5, run.FAILED)]
    assert "crashes" in found[1]["reason"]


def test_results_are_kept_and_counted(tmp_path: Path) -> None:
    arguments = ["--scenes", "4", "--jobs", "1", "--output", str(tmp_path / "absurd.json")]
    assert command.main(arguments) == 0
    kept = (tmp_path / "absurd.jsonl").read_text()
    assert command.main(arguments) == 0
    assert (tmp_path / "absurd.jsonl").read_text() == kept
    assert len(kept.splitlines()) == 4


def test_causes_of_alike_errors_are_one() -> None:
    words = [
        run.Outcome(n, "speeds", run.ERROR, f"the step at {n} s moves joint 'a{n}' from nothing").words()
        for n in (1, 2)
    ]
    assert summary.figures(words)["causes"][run.ERROR] == {"a step moves things too far to follow": [1, 2]}
