"""A sweep trains each combination once, survives what goes wrong in one run, and goes on where it was stopped."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import onnx
import pytest

from manyhands import cli
from manyhands.cli.sweep import parse_choices
from manyhands.training.lock import locked
from manyhands.training.recorder import Row
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import TrainSettings
from manyhands.training.sweep import SweepRun, grid
from manyhands.training.sweep_progress import figures

TINY = ("--num-envs", "16", "--max-steps", "1600", "--episodes", "20")
ENDLESS = ("--num-envs", "16", "--max-steps", "100000000", "--episodes", "20", "--set", "stop_streak=0")


def names(parent: Path) -> list[str]:
    return sorted(path.name for path in parent.iterdir() if path.is_dir())


def written(parent: Path) -> dict[str, int]:
    """When the evaluation of each run was written."""
    return {path.parent.name: path.stat().st_mtime_ns for path in parent.glob("*/evaluation.json")}


def test_values_and_their_combinations() -> None:
    assert parse_choices(["algorithm=SAC,TD3"]) == {"algorithm": ["SAC", "TD3"]}
    choices = parse_choices(["gamma=0.9,0.95", "hidden_layers=[8, 8],[16]"])
    assert choices == {"gamma": [0.9, 0.95], "hidden_layers": [[8, 8], [16]]}
    assert grid(choices) == [
        {"gamma": gamma, "hidden_layers": layers} for gamma in (0.9, 0.95) for layers in ([8, 8], [16])
    ]
    assert grid({}) == [{}]


def test_each_combination_and_seed_is_trained_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    out = tmp_path / "sweep"
    command = ["sweep", "PandaReach", *TINY, "--out", str(out), "--set", "hidden_layers=[8,8],[16]"]
    assert cli.main([*command, "--seeds", "1"]) == 0
    assert names(out) == ["hidden_layers=16,seed=0", "hidden_layers=8x8,seed=0"]
    text = capsys.readouterr().out
    assert "hidden_layers=[8, 8]" in text and "worst" in text and "best" in text
    assert (out / "comparison.png").is_file() and (out / "comparison.html").is_file()
    for name, layers in (("16", [16]), ("8x8", [8, 8])):
        config = json.loads((out / f"hidden_layers={name},seed=0" / "config.json").read_text())
        assert config["trainer"]["hidden_layers"] == layers
        assert (config["settings"]["num_threads"], config["settings"]["max_env_steps"]) == (1, 1600)

    before = written(out)
    assert cli.main([*command, "--seeds", "2"]) == 0, "another seed is added to those that are there"
    assert "4 runs, 2 of them done already" in capsys.readouterr().out
    after = written(out)
    assert len(after) == 4 and {name: after[name] for name in before} == before


def test_a_run_of_a_sweep_is_the_run_of_train(tmp_path: Path) -> None:
    out = tmp_path / "sweep"
    assert cli.main(["sweep", "PandaReach", *TINY, "--seeds", "2", "--set", "gamma=0.9", "--out", str(out)]) == 0
    arguments = ["--seed", "1", "--set", "gamma=0.9", "--runs", str(tmp_path / "runs")]
    assert cli.main(["train", "PandaReach", *TINY, *arguments]) == 0
    (alone,) = (tmp_path / "runs").iterdir()

    def weights(folder: Path) -> list[bytes]:
        return [tensor.raw_data for tensor in onnx.load(folder / "policy.onnx").graph.initializer]

    assert weights(out / "gamma=0.9,seed=1") == weights(alone) != weights(out / "gamma=0.9,seed=0")


def test_one_bad_run_does_not_stop_the_others(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["sweep", "PandaReach", *TINY, "--seeds", "3", "--jobs", "1", "--out", str(tmp_path)]
    assert cli.main(command) == 0
    for seed in (0, 2):
        (tmp_path / f"seed={seed}" / "evaluation.json").unlink()
    (tmp_path / "seed=0" / "checkpoint.bin").write_bytes(b"half of a checkpo")
    capsys.readouterr()
    assert cli.main(command) == 1
    out = capsys.readouterr().out
    assert "3 runs, 1 of them done already" in out
    (line,) = [line for line in out.splitlines() if line.startswith("seed=0 failed")]
    assert "checkpoint.bin" in line and str(tmp_path / "seed=0" / "log.txt") in line
    assert set(written(tmp_path)) == {"seed=1", "seed=2"}
    assert "PandaReach-v3: success at the end" in out, "those that went well are compared"
    (tmp_path / "seed=0" / "checkpoint.bin").unlink()
    assert cli.main(command) == 0, "the same command tries again"


def start(out: Path, *arguments: str) -> subprocess.Popen[str]:
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", program, "sweep", "PandaReach", "--out", str(out), *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def wait_until(condition: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 120
    while not condition():
        if time.monotonic() > deadline or process.poll() is not None:
            process.kill()
            pytest.fail(f"the sweep did nothing: {process.communicate()}")
        time.sleep(0.05)


def rows(folder: Path) -> list[str]:
    metrics = folder / "metrics.csv"
    return metrics.read_text().splitlines()[1:] if metrics.is_file() else []


@pytest.mark.parametrize("everybody", [True, False])
def test_ctrl_c_leaves_everything_resumable(everybody: bool, tmp_path: Path) -> None:
    """Whether it reaches the whole group of processes, as from a keyboard, or the sweep alone."""
    folders = [tmp_path / f"stop_streak=0,seed={seed}" for seed in range(3)]
    process = start(tmp_path, *ENDLESS, "--seeds", "3", "--jobs", "2")
    wait_until(lambda: all(len(rows(folder)) > 2 for folder in folders[:2]), process)
    (os.killpg if everybody else os.kill)(process.pid, signal.SIGINT)
    text, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, "")
    assert "Stopped with 0 of 3 runs done. The same command goes on from here." in text and "failed" not in text
    assert names(tmp_path) == [folder.name for folder in folders]
    assert [(folder / "checkpoint.bin").is_file() for folder in folders] == [True, True, False]
    assert not (tmp_path / "comparison.png").exists()

    before = [rows(folder) for folder in folders]
    limit = 1600 + max(int(of[-1].split(",")[1]) for of in before[:2])
    for folder in map(RunFolder, folders):  # an end is given to them
        folder.write_config(folder.read_settings(max_env_steps=limit))
    again = [str(limit) if part == "100000000" else part for part in ENDLESS]
    assert cli.main(["sweep", "PandaReach", *again, "--seeds", "3", "--out", str(tmp_path)]) == 0
    for folder, of in zip(folders, before, strict=True):
        after = rows(folder)
        assert after[: len(of)] == of and len(after) > len(of), "what was trained is not trained again"
        assert int(after[-1].split(",")[1]) == -(-limit // 16) * 16
    assert len(written(tmp_path)) == 3 and (tmp_path / "comparison.png").is_file()


def test_processes_end_with_the_sweep(tmp_path: Path) -> None:
    process = start(tmp_path, *ENDLESS, "--seeds", "1")
    folder = tmp_path / "stop_streak=0,seed=0"
    wait_until(lambda: len(rows(folder)) > 2, process)
    process.kill()
    process.communicate()
    deadline = time.monotonic() + 60
    while not (folder / "policy.onnx").is_file():
        assert time.monotonic() < deadline, "the run goes on without its sweep"
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["PandaReech"], "did you mean PandaReach-v3"),
        (["PandaReach", "--set", "gama=0.9,0.95"], "'gama' is no trainer setting; did you mean gamma?"),
        (
            ["PandaReach", "--set", "seed=1,2"],
            "'seed' is no trainer setting: --seed sets it, and --seeds N has a sweep",
        ),
        (["PandaReach", "--set", "gamma=0.9,0.95,0.90"], "has a value twice"),
        (["PandaReach", "--set", "gamma"], "expected NAME=VALUE,..."),
        (["PandaReach", "--set", "gamma="], "has no value"),
        (["PandaReach", "--set", "gamma=0.9,high"], "are no numbers"),
        (["PandaReach", "--set", "gamma=0.9,1.5"], "gamma"),
        (["PandaReach", "--set", "gamma=0.9", "--set", "gamma=0.95"], "gamma is set twice"),
        (["PandaReach", "--seeds", "0"], "--seeds is 0"),
        (["PandaReach", "--jobs", "0"], "--jobs is 0"),
        (["PandaReach", "--num-envs", "0"], "num_envs is 0"),
        (["PandaReach", "--recipe", "none.yaml"], "none.yaml"),
    ],
)
def test_bad_requests_are_explained_and_leave_nothing(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["sweep", *arguments, "--out", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert not list(tmp_path.iterdir())


def test_folders_that_cannot_be_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["sweep", "PandaReach", "--out", "/proc/x"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("manyhands sweep: no run can be kept in /proc/x (") and line.endswith("with --out")
    assert cli.main(["sweep", "PandaReach", *TINY, "--seeds", "1", "--out", str(tmp_path)]) == 0
    assert cli.main(["sweep", "PandaReach", "--seeds", "1", "--out", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{tmp_path / 'seed=0'} holds a run with num_envs=16, wanted is 64: name another folder" in line
    for other in ([], ["--set", "gamma=0.9"]):  # folders of other names, too
        assert cli.main(["sweep", "PandaPush", "--seeds", "1", *other, "--out", str(tmp_path)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert f"{tmp_path} holds runs of PandaReach-v3, wanted is PandaPush-v3: name another folder" in line
    assert names(tmp_path) == ["seed=0"]
    with locked(tmp_path):
        assert cli.main(["sweep", "PandaReach", *TINY, "--seeds", "1", "--out", str(tmp_path)]) == 2
    assert f"trains in {tmp_path} already" in capsys.readouterr().err


def test_a_randomised_sweep_is_what_train_makes_of_it(tmp_path: Path) -> None:
    arguments = ["PandaPush", *TINY, "--randomize", "--set", "gamma=0.9"]
    out, runs = tmp_path / "sweep", tmp_path / "runs"
    assert cli.main(["sweep", *arguments, "--seeds", "1", "--out", str(out)]) == 0
    assert names(out) == ["randomize,gamma=0.9,seed=0"]
    assert cli.main(["train", *arguments, "--threads", "1", "--runs", str(runs)]) == 0
    (alone,) = runs.iterdir()
    swept = RunFolder(out / names(out)[0]).read_settings()
    assert swept.randomize and swept == RunFolder(alone).read_settings()
    assert (out / names(out)[0] / "checkpoint.bin").read_bytes() == (alone / "checkpoint.bin").read_bytes()


def test_a_run_that_is_done_has_no_share_left(tmp_path: Path) -> None:
    row = Row(100, 1_600, 0, 10, 0.5, 0.5, 1, 0.0, 0.0, 0.0, 100.0, 10.0)
    run = SweepRun(RunFolder(tmp_path), TrainSettings("PandaReach-v3", max_env_steps=160_000), row=row)
    assert figures(run) == ("1,600 (1%)", "50.0%", "10.0")
    run.state = "done"
    assert figures(run) == ("1,600", "50.0%", "10.0")
