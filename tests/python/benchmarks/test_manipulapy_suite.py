"""What ManipulaPy's own tests say is judged by a list of known differences, and nothing else passes."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[3]))

from benchmarks.manipulapy_suite import __main__ as suite
from benchmarks.manipulapy_suite.differences import DIFFERENCES, LEFT_OUT, Difference

KNOWN = (
    Difference("test_a.py", "TestX::*", 2, "a fault of theirs"),
    Difference("test_a.py", "test_slow", None, "the clock"),
    Difference("test_b.py", "*", 1, "another file"),
)


def test_known_failures_are_no_surprise() -> None:
    outcomes = {"TestX::one": "failed", "TestX::two": "failed", "TestX::three": "passed", "test_four": "skipped"}
    assert suite.judge("test_a.py", outcomes, KNOWN) == suite.Verdict(1, 1, 2, [])
    assert suite.judge("test_a.py", {**outcomes, "test_slow": "failed"}, KNOWN) == suite.Verdict(1, 1, 3, [])


def test_anything_else_is_a_surprise() -> None:
    mended = suite.judge("test_a.py", {"TestX::one": "failed", "TestX::two": "passed"}, KNOWN)
    assert mended.surprises == ["test_a.py::TestX::*: 1 fail, 2 are known"]
    new = suite.judge("test_a.py", {"TestX::one": "failed", "TestX::two": "failed", "test_new": "failed"}, KNOWN)
    assert new.surprises == ["test_a.py::test_new fails"]
    assert suite.judge("test_c.py", {"the file itself": "failed"}, KNOWN).surprises == [
        "test_c.py::the file itself fails"
    ]


def test_a_file_runs_in_a_process_of_its_own_on_our_modules(tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "tests" / "test_ours.py").write_text(
        "import pytest\nimport pybullet\nfrom ManipulaPy.path_planning import TrajectoryPlanning, _traj_cpu_njit\n"
        "def test_ours(): assert TrajectoryPlanning.__module__.startswith('manyhands.')\n"
        "def test_wrong(): assert pybullet.__name__ != 'manyhands.pybullet'\n"
        "def test_skipped(): pytest.skip()\n"
    )
    assert suite.run(tmp_path, "test_ours.py") == {
        "test_ours": "passed", "test_wrong": "failed", "test_skipped": "skipped",
    }  # fmt: skip
    (tmp_path / "tests" / "test_broken.py").write_text("import no_such_module\n")
    assert suite.run(tmp_path, "test_broken.py") == {"the file itself": "failed"}
    (tmp_path / "tests" / "test_crash.py").write_text("import os\ndef test_it(): os._exit(3)\n")
    assert suite.run(tmp_path, "test_crash.py") == {"the file itself": "failed"}


def test_what_hangs_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_hangs.py").write_text("import time\ndef test_it(): time.sleep(1000)\n")
    monkeypatch.setattr(suite, "PATIENCE", 5.0)
    assert suite.run(tmp_path, "test_hangs.py") == {"the file itself, after 5 s": "failed"}


def test_every_difference_has_a_reason_and_its_file_is_run() -> None:
    assert all(one.reason and one.file not in LEFT_OUT for one in DIFFERENCES)
    assert all(LEFT_OUT.values())
