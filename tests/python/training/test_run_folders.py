"""A run folder appears whole, is written to by one process at a time, and is not touched where nothing is trained."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from manyhands import cli
from manyhands.training.lock import locked
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import TrainSettings

SHORT = ("--num-envs", "16", "--episodes", "20", "--threads", "1")


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def unsolved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 1600 steps that is not solved."""
    runs = tmp_path_factory.mktemp("runs")
    assert cli.main(["train", "PandaReach", *SHORT, "--max-steps", "1600", "--runs", str(runs)]) == 0
    (path,) = runs.iterdir()
    return path


def test_resuming_a_solved_run_changes_nothing(reach_policy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = contents(reach_policy)
    for limit in ("100", "100000000"):
        assert cli.main(["train", "--resume", str(reach_policy), "--max-steps", limit]) == 0
        assert "Solved already" in capsys.readouterr().out
        assert contents(reach_policy) == before


def test_resuming_a_run_at_its_limit_changes_nothing(unsolved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = contents(unsolved)
    assert cli.main(["train", "--resume", str(unsolved)]) == 0
    assert "All 1,600 steps are done" in capsys.readouterr().out
    assert cli.main(["train", "--resume", str(unsolved), "--max-steps", "100"]) == 2
    assert contents(unsolved) == before


def test_a_folder_has_one_trainer(unsolved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = f"""
import sys
from pathlib import Path
from manyhands.training.lock import locked
with locked(Path({str(unsolved)!r})):
    print("locked", flush=True)
    sys.stdin.read()
"""
    before = contents(unsolved)
    with subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None and holder.stdout.readline() == b"locked\n"
        try:
            assert cli.main(["train", "--resume", str(unsolved), "--max-steps", "3200"]) == 2
            (line,) = capsys.readouterr().err.splitlines()
            assert f"process {holder.pid} on " in line and f"trains in {unsolved} already" in line
            assert {name: data for name, data in contents(unsolved).items() if name != ".lock"} == before
        finally:
            holder.send_signal(signal.SIGKILL)
    assert (unsolved / ".lock").is_file(), "it had no time to tidy up"
    with locked(unsolved):  # a dead process holds nothing
        pass
    assert contents(unsolved) == before


def test_two_trainings_at_once(tmp_path: Path) -> None:
    """The commands themselves: of two that resume one run, one is refused."""
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", program, "train"]
    endless = ["PandaReach", *SHORT, "--max-steps", "100000000", "--set", "stop_streak=0", "--runs", str(tmp_path)]
    with subprocess.Popen([*command, *endless], stdout=subprocess.PIPE) as first:
        deadline = time.monotonic() + 60
        while not (locks := list(tmp_path.glob("Panda*/.lock"))):
            assert time.monotonic() < deadline and first.poll() is None
            time.sleep(0.01)
        second = subprocess.run(
            [*command, "--resume", str(locks[0].parent)], capture_output=True, text=True, timeout=60
        )
        first.send_signal(signal.SIGINT)
    assert (second.returncode, second.stdout) == (2, "")
    assert f"process {first.pid} on " in second.stderr
    assert not locks[0].exists()


def test_locks_are_let_go(tmp_path: Path) -> None:
    twice = pytest.raises(BlockingIOError, match="already: wait until it ends")
    for _ in range(2):
        with locked(tmp_path), twice, locked(tmp_path):
            pytest.fail("two hold it")
    assert not contents(tmp_path)


def test_a_folder_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    settings = TrainSettings("PandaReach-v3")

    def refuse(_: Path) -> None:
        raise OSError("the disk is full")

    with pytest.raises(OSError, match="the disk is full"):
        RunFolder.create(tmp_path, settings, refuse)
    assert not list(tmp_path.iterdir())
    made = [RunFolder.create(tmp_path, settings, Path.touch) for _ in range(3)]
    assert len({folder.path for folder in made}) == 3, "also where the name is taken"
    for folder in made:
        assert contents(folder.path).keys() == {"config.json", "checkpoint.bin"}


def test_what_cannot_be_made_leaves_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["train", "PandaReach", "--num-envs", "100000000", "--runs", str(tmp_path)]) == 2
    assert "memory" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
