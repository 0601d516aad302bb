"""`make bench`: its file, its verdicts, and that wrong results get no figure."""

import json
import mmap
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
sys.path.insert(0, str(ROOT))

from benchmarks import __main__ as command  # noqa: E402
from benchmarks import memory, programs, report, targets, tasks, time_step  # noqa: E402
from benchmarks.rows import Contender, Row, measure_in_turns  # noqa: E402

FIELDS = {"benchmark", "engine", "number_type", "threads", "value", "unit", "ratio"}
LINE = {
    "benchmark": "ABA",
    "engine": "manyhands",
    "number_type": "lanes8",
    "threads": 1,
    "value": 90.0,
    "unit": "ns/arm",
    "wall": 91.0,
    "variation": 0.01,
    "hash": "0123456789abcdef",
    "wrong": "",
}


@pytest.fixture
def programs_folder(tmp_path: Path) -> Path:
    """Stand-ins for the C++ benchmarks that print one row each."""
    for name in programs.PROGRAMS:
        program = tmp_path / name
        program.write_text(f"#!/bin/sh\ncat <<'end'\n{json.dumps(LINE | {'benchmark': name})}\nend\n")
        program.chmod(0o755)
    return tmp_path


def test_quick_run_writes_the_rows(programs_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = programs_folder / "out" / "bench.json"
    assert command.main(["--quick", "--programs", str(programs_folder), "--output", str(output)]) == 0
    written = json.loads(output.read_text())
    assert {"cpu", "date", "compiler"} <= written.keys()
    rows = written["rows"]
    assert all(row.keys() >= FIELDS for row in rows)
    measured = {(row["benchmark"], row["threads"]): row["value"] for row in rows if row["engine"] == "manyhands"}
    for threads in (1, 2):
        for name in ("Reach random", "Push expert"):
            assert measured[f"{name}, make_vec of {tasks.WORLDS}", threads] > 0
    assert measured["dynamics", 1] == 90
    assert list(output.parent.iterdir()) == [output]
    assert "Reach random, gymnasium.make" in capsys.readouterr().out


def test_missing_program_is_a_row(tmp_path: Path) -> None:
    rows = programs.run_programs(tmp_path, quick=True)
    assert [row.benchmark for row in rows] == list(programs.PROGRAMS)
    assert all(row.value is None and "not built" in row.note and not row.wrong for row in rows)


def test_wrong_result_has_no_figure() -> None:
    row = programs.read_row(json.dumps(LINE | {"wrong": "not the bits of the scalar float run"}))
    assert row.wrong
    assert row.value is None
    assert "not the bits" in row.note


def test_failing_program_is_wrong(programs_folder: Path) -> None:
    program = programs_folder / "dynamics"
    program.write_text("#!/bin/sh\nexit 3\n")
    rows = programs.run_programs(programs_folder, quick=True)
    assert [row.note for row in rows if row.wrong] == [f"REFUSED: {program} ended with status 3"]


@pytest.mark.parametrize("policy", tasks.POLICIES)
def test_replay_tells_one_wrong_action(policy: str) -> None:
    envs = tasks.vector_env("Reach", policy, 8, 1)
    envs.run(60)  # more than an episode
    row = Row("Reach", "manyhands", "float32", 1, 1.0, tasks.UNIT)
    tasks.check(row, envs)
    assert not row.wrong
    right = envs.act
    envs.act = lambda observation, step: -right(observation, step)
    envs.run(1)
    envs.act = right
    tasks.check(row, envs)
    assert row.wrong


@pytest.mark.parametrize(("run", "count"), [(memory.vector("Push"), 6400), (memory.single("Stack"), 600)])
def test_randomized_resets_and_steps_leave_no_memory_taken(run: Callable[[int], None], count: int) -> None:
    assert memory.measure(run, count).growth <= memory.MOST_GROWTH


def test_what_stays_is_told() -> None:
    kept: list[mmap.mmap] = []

    def keep(megabytes: int) -> None:
        kept.append(mmap.mmap(-1, megabytes * 1_000_000))
        kept[-1].write(b"x" * len(kept[-1]))

    assert memory.measure(keep, 10).growth == pytest.approx(9, abs=0.5)


def test_shorter_time_steps_come_nearer(capsys: pytest.CaptureFixture[str]) -> None:
    assert time_step.main(["--worlds", "8", "--tasks", "Reach"]) == 0
    rows = [line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[1].strip() for row in rows] == ["1 ms", "2 ms", "4 ms", "8 ms"]
    assert all(row[6].strip() == "0" and row[7].strip() == "100 %" for row in rows)
    assert float(rows[0][2]) < float(rows[3][2]) < 20, "mm, of the hand"
    assert all(float(row[8].replace(",", "")) > 0 for row in rows)


def test_rates_are_units_per_second() -> None:
    done: list[int] = []
    contender = Contender(Row("work", "test", "", 1, None, "1/s"), done.append, units=7, calls=3)
    measure_in_turns([contender], rounds=5, seconds=1.0)
    assert done == [3] * 5
    assert contender.total_calls == 15
    assert contender.row.value == pytest.approx(np.median(contender.rates))


def test_verdicts() -> None:
    vector = f"Reach random, make_vec of {tasks.WORLDS}"
    rows = [
        Row("RNEA", "manyhands", "lanes8", 1, 101.0, "ns/arm"),
        Row("ABA", "manyhands", "lanes8", 1, 120.0, "ns/arm"),
        Row("ABA", "manyhands", "lanes16", 1, 99.0, "ns/arm"),
        Row("ABA", "Pinocchio 4", "double", 1, 990.0, "ns/arm"),
        Row(vector, "manyhands", "float32", 1, 3e5, tasks.UNIT, ratio=301.0, ratio_to="panda-gym"),
        Row(vector, "manyhands", "float32", 2, 5e5, tasks.UNIT, ratio=1.7, ratio_to="1 thread"),
    ]
    targets.compare_with_peers(rows)
    targets.judge(rows)
    assert [row.verdict for row in rows] == ["short", "", "pass", "", "pass", "short"]
    assert rows[2].ratio == 10
    assert "pass" in report.table(rows)


def test_stage_shares() -> None:
    rows = [
        Row(report.STAGE + name, "manyhands", "lanes8", 1, value, "ns/env step")
        for name, value in (("inverse kinematics", 250.0), ("integrate", 500.0), ("all", 1000.0))
    ]
    lines = report.stage_tree(rows).splitlines()
    assert [line.split()[-1] for line in lines[1:]] == ["100%", "25%", "50%", "25%"]
