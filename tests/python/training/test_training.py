"""A training run leaves what it promises, can be stopped and resumed, and its policy file is its policy."""

import csv
import io
import json
import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import onnx
import pytest
from rich.console import Console
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from manyhands import cli
from manyhands._core.envs import make_env_batch
from manyhands._core.learn import Trainer, TrainerConfig
from manyhands.env_names import resolve_env_id
from manyhands.files import replacing
from manyhands.training.evaluation import PolicyFile, evaluate
from manyhands.training.policy_file import save_policy
from manyhands.training.progress import TrainingProgress
from manyhands.training.recipe import expected, find_recipe
from manyhands.training.recorder import Recorder, Row
from manyhands.training.run import TrainingRun
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import TrainSettings, parse_overrides

PNG = b"\x89PNG\r\n"


def train(parent: Path, *arguments: str) -> RunFolder:
    """The folder of a run that ended well."""
    before = set(parent.glob("*"))
    assert cli.main(["train", *arguments, "--runs", str(parent)]) == 0
    (path,) = set(parent.glob("*")) - before
    return RunFolder(path)


@pytest.fixture(scope="module")
def reach(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return train(tmp_path_factory.mktemp("runs"), "PandaReach", "--seed", "0")


def test_reach_is_learned(reach: RunFolder) -> None:
    result = json.loads(reach.evaluation.read_text())
    assert result["episodes"] == 1000
    assert result["success_rate"] >= 0.99
    assert -result["mean_length"] <= result["mean_return"] < 0
    assert 1 <= result["mean_length"] < 10


def test_the_folder_holds_everything(reach: RunFolder) -> None:
    assert re.fullmatch(r"PandaReach-v3-\d{8}-\d{6}-0", reach.path.name)
    config = json.loads(reach.config.read_text())
    assert config["settings"]["env_id"] == "PandaReach-v3"
    assert config["trainer"] == reach.read_settings().trainer_config().to_dict()
    assert config["seeds"] == {"training": 0, "evaluation": [10**9, 10**9 + 999]}
    assert config["versions"]["numpy"] == np.__version__
    assert reach.curve.read_bytes().startswith(PNG)
    assert not list(reach.path.glob(".*")), "temporary files are left"

    with reach.metrics.open(newline="") as file:
        rows = list(csv.DictReader(file))
    steps = [int(row["env_steps"]) for row in rows]
    assert steps == sorted(set(steps))
    assert float(rows[-1]["evaluation_success_rate"]) == 1.0
    begin = next(int(row["episodes"]) for row in rows if int(row["gradient_steps"]) > 0)
    known = [int(row["episodes"]) >= begin + 100 for row in rows]
    assert [row["success_rate"] != "nan" for row in rows] == known
    assert not known[0] and known[-1], "the first rows know only of episodes before learning"
    seconds = [float(row["seconds"]) for row in rows]
    assert seconds == sorted(seconds)

    events = EventAccumulator(str(reach.path)).Reload()
    recorded = [(event.step, event.value) for event in events.Scalars("train/success_rate")]
    assert [step for step, _ in recorded] == steps
    np.testing.assert_allclose([value for _, value in recorded], [float(row["success_rate"]) for row in rows], 1e-6)


@pytest.mark.parametrize("differences", [[], [3, 0, 1, 2]])
def test_the_policy_file_acts_as_the_trainers_policy(differences: list[int], tmp_path: Path) -> None:
    config = TrainerConfig()
    config.hidden_layers = [16, 24, 8]
    config.differences = differences
    trainer = Trainer(make_env_batch("PandaReachJoints-v3", 32), None, config)
    trainer.advance(150)
    policy = trainer.policy()
    save_policy(policy, "PandaReachJoints-v3", tmp_path / "policy.onnx")
    rng = np.random.default_rng(0)
    for count in (1, 500):
        rows = {"observation": 6, "achieved_goal": 3, "desired_goal": 3}
        obs = {name: rng.normal(scale=2, size=(count, size)).astype(np.float32) for name, size in rows.items()}
        seen = obs["observation"]
        x = [seen, obs["desired_goal"], obs["desired_goal"] - obs["achieved_goal"]]
        x += [seen[:, i : i + 3] - seen[:, k : k + 3] for i, k in zip(differences[::2], differences[1::2], strict=True)]
        x = np.hstack(x)
        x = np.clip((x.astype(float) - policy.mean) * policy.scale, -policy.clip, policy.clip)
        for i, (weight, bias) in enumerate(policy.layers):
            x = weight.astype(float) @ x.T
            x = x.T + bias
            x = np.tanh(x) if i == len(policy.layers) - 1 else np.maximum(x, 0)
        np.testing.assert_allclose(PolicyFile(tmp_path / "policy.onnx")(obs), x, atol=1e-5)


def test_evaluation_by_the_file_is_the_trainers_evaluation(reach: RunFolder) -> None:
    by_trainer = json.loads(reach.evaluation.read_text())
    by_file = evaluate(PolicyFile(reach.policy), "PandaReach-v3", 1000, by_trainer["first_seed"], num_threads=1)
    assert by_file.success_rate == pytest.approx(by_trainer["success_rate"], abs=0.002)
    assert by_file.mean_return == pytest.approx(by_trainer["mean_return"], abs=0.01)
    assert by_file.mean_length == pytest.approx(by_trainer["mean_length"], abs=0.01)


def test_evaluate_command(reach: RunFolder, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", str(reach.path), "--episodes", "50", "--json"]) == 0
    first = json.loads(capsys.readouterr().out)
    assert (first["env_id"], first["episodes"]) == ("PandaReach-v3", 50)
    arguments = ["--env", "PandaReachDense", "--episodes", "50"]
    assert cli.main(["evaluate", str(reach.policy), *arguments]) == 0
    assert capsys.readouterr().out.startswith("PandaReachDense-v3: success ")
    assert cli.main(["evaluate", str(reach.policy), "--env", "PandaReachJoints"]) == 2
    assert "does not fit PandaReachJoints-v3" in capsys.readouterr().err


SETTINGS = ("stop_streak=0", "warmup_transitions=800", "updates_per_iteration=2", "evaluation_episodes=50")
SHORT = ("--num-envs", "16", "--episodes", "20", *(part for one in SETTINGS for part in ("--set", one)))


@pytest.fixture(scope="module")
def short_run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    return train(tmp_path_factory.mktemp("runs"), "PandaReach", *SHORT, "--max-steps", "1600")


def policy_bytes(folder: RunFolder) -> list[bytes]:
    return [tensor.raw_data for tensor in onnx.load(folder.policy).graph.initializer]


def test_a_resumed_run_is_the_uninterrupted_run(tmp_path: Path) -> None:
    whole = train(tmp_path, "PandaReach", *SHORT, "--max-steps", "3200", "--seed", "5")
    parted = train(tmp_path, "PandaReach", *SHORT, "--max-steps", "2000", "--seed", "5")
    assert policy_bytes(parted) != policy_bytes(whole)
    assert cli.main(["train", "--resume", str(parted.path), "--max-steps", "3200"]) == 0
    assert policy_bytes(parted) == policy_bytes(whole)
    assert parted.evaluation.read_text() == whole.evaluation.read_text()

    def last_row(folder: RunFolder) -> dict[str, str]:
        with folder.metrics.open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["iterations"]) for row in rows] == sorted({int(row["iterations"]) for row in rows})
        return {name: rows[-1][name] for name in ("iterations", "env_steps", "episodes", "success_rate")}

    assert last_row(parted) == last_row(whole)


@pytest.mark.parametrize(
    ("name", "damage", "message"),
    [
        ("metrics.csv", lambda text: text.rpartition(",")[0], r"metrics.csv:\d+: expected 12 numbers, found"),
        ("metrics.csv", lambda text: text.replace("1", "one", 40), "metrics.csv:2: expected 12 numbers, found"),
        ("metrics.csv", lambda _: "", "metrics.csv:1: expected the header iterations,env_steps"),
        ("metrics.csv", lambda text: text.replace("episodes", "plays"), "metrics.csv:1: expected the header"),
        ("config.json", lambda text: text[:100], r"config.json:\d+: expected JSON"),
        ("config.json", lambda _: "[]", "config.json: expected the settings of a run"),
        ("config.json", lambda _: '{"settings": {}}', "config.json: expected the settings of a run.*env_id"),
        ("config.json", lambda text: text.replace('"num_envs": 16', '"num_envs": "16"'), "num_envs is '16'"),
        ("config.json", lambda text: text.replace('"num_envs": 16', '"worlds": 16'), "config.json: .*'worlds'"),
    ],
)
def test_damaged_files_are_named_on_resuming(
    name: str, damage: Callable[[str], str], message: str, short_run: RunFolder,
    tmp_path: Path, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    folder = Path(shutil.copytree(short_run.path, tmp_path / "run"))
    (folder / name).write_text(damage((folder / name).read_text()))
    assert cli.main(["train", "--resume", str(folder), "--max-steps", "3200"]) == 2
    assert re.search(message, capsys.readouterr().err)


def test_a_solved_run_and_a_limit_that_is_reached_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    solved = train(tmp_path, "PandaReach", "--seed", "0", "--episodes", "20")
    assert cli.main(["train", "--resume", str(solved.path)]) == 0
    assert "Solved already" in capsys.readouterr().out
    parted = train(tmp_path, "PandaReach", *SHORT, "--max-steps", "1600")
    assert cli.main(["train", "--resume", str(parted.path), "--max-steps", "800"]) == 2
    assert "has done 1600 steps already: --max-steps 800 adds none" in capsys.readouterr().err
    assert parted.read_settings().max_env_steps == 1600


def test_printed_commands_are_those_that_the_users_shell_finds(tmp_path: Path) -> None:
    """Called by path it says the path, called by name the name; what it prints runs, spaces in paths included."""
    script = Path(sys.executable).with_name("manyhands")
    runs = tmp_path / "my runs"
    for path, called in (("/usr/bin:/bin", str(script)), (f"{script.parent}:/usr/bin:/bin", script.name)):
        assert shutil.which(script.name, path=path) == (None if called == str(script) else str(script))
        arguments = [str(script), "train", "PandaReach", *SHORT, "--max-steps", "1600", "--runs", str(runs)]
        result = subprocess.run(arguments, env={"PATH": path}, capture_output=True, text=True, check=True)
        commands = [line.strip() for line in result.stdout.partition("Next:")[2].splitlines() if line.strip()]
        assert [shlex.split(line)[:2] for line in commands[:3]] == [
            [called, "evaluate"], [called, "view"], [called, "train"]
        ]  # fmt: skip
        assert shlex.split(commands[3]) == [str(Path(called).with_name("tensorboard")), "--logdir", str(runs)]
        again = subprocess.run(commands[0], shell=True, env={"PATH": path}, capture_output=True, text=True)
        assert "success" in again.stdout, again.stderr


def start_endless_run(parent: Path) -> subprocess.Popen[str]:
    arguments = ["train", "PandaReach", *SHORT, "--max-steps", "100000000", "--runs", str(parent)]
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def wait_for_rows(parent: Path, process: subprocess.Popen[str]) -> RunFolder:
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and process.poll() is None:
        for metrics in parent.glob("*/metrics.csv"):
            if len(metrics.read_text().splitlines()) > 3:
                return RunFolder(metrics.parent)
        time.sleep(0.05)
    process.kill()
    pytest.fail(f"the run recorded nothing: {process.communicate()}")


def test_ctrl_c_saves_a_checkpoint_from_which_the_run_goes_on(tmp_path: Path) -> None:
    process = start_endless_run(tmp_path)
    folder = wait_for_rows(tmp_path, process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    assert f"manyhands train --resume {folder.path}" in out.replace("\n", " ")
    assert "Stopping: what was learned is being saved" in out
    assert folder.checkpoint.is_file()
    assert folder.curve.read_bytes().startswith(PNG)
    assert not folder.evaluation.exists()
    with folder.metrics.open(newline="") as file:
        steps = int(list(csv.DictReader(file))[-1]["env_steps"])

    limit = steps + 1600
    assert cli.main(["train", "--resume", str(folder.path), "--max-steps", str(limit)]) == 0
    with folder.metrics.open(newline="") as file:
        assert int(list(csv.DictReader(file))[-1]["env_steps"]) == -(-limit // 16) * 16
    assert folder.evaluation.is_file()


def test_ctrl_c_twice_says_how_to_go_on(tmp_path: Path) -> None:
    process = start_endless_run(tmp_path)
    folder = wait_for_rows(tmp_path, process)
    for _ in range(2):
        process.send_signal(signal.SIGINT)
        time.sleep(0.05)
    out, err = process.communicate(timeout=60)
    assert process.returncode in (130, -signal.SIGINT), err
    assert "Traceback" not in err
    assert f"manyhands train --resume {folder.path}" in out.replace("\n", " ")


@pytest.mark.parametrize(("writer", "module"), [("_save_policy", "policy_file"), ("_draw_curve", "curve")])
def test_ctrl_c_waits_for_modules_that_are_being_loaded(
    writer: str, module: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Packages that are written in C++ crash where it strikes as they are made; onnx does."""
    name = f"manyhands.training.{module}"

    class Striking:
        """Finds nothing; somebody presses Ctrl-C as it looks."""

        def find_spec(self, wanted: str, *_: object) -> None:
            if wanted == name:
                signal.raise_signal(signal.SIGINT)

    monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "meta_path", [Striking(), *sys.meta_path])
    arguments = {"_save_policy": [None], "_draw_curve": [None, SimpleNamespace(rows=[1]), None]}
    with pytest.raises(KeyboardInterrupt):
        getattr(TrainingRun, writer)(None, *arguments[writer])
    assert name in sys.modules


def test_required_success_decides_the_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["train", "PandaReach", *SHORT, "--max-steps", "16", "--runs", str(tmp_path), "--require-success"]
    assert cli.main([*arguments, "0.99"]) == 1
    assert "is below 99.0%" in capsys.readouterr().err
    assert cli.main([*arguments, "0.0"]) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "manyhands train PandaReach"),
        (["PandaReech"], "did you mean PandaReach-v3"),
        (["PandaReach", "--set", "gama=0.9"], "'gama' is no trainer setting; did you mean gamma?"),
        (["PandaReach", "--set", "gamma"], "expected NAME=VALUE"),
        (["PandaReach", "--set", "gamma=high"], "is no number"),
        (["PandaReach", "--set", 'gamma="high"'], "gamma is 'high', expected a number"),
        (["PandaReach", "--set", "gamma=1.5"], "gamma"),
        (["PandaReach", "--num-envs", "0"], "num_envs is 0"),
        (["PandaReach", "--seed", "-1"], "seed is -1"),
        (["PandaReach", "--recipe", "nowhere.yaml"], "there is no file nowhere.yaml with a recipe"),
        (["--resume", "nowhere"], "nowhere is no run folder"),
        (
            ["PandaReach", "--resume", "nowhere", "--set", "gamma=0.9", "--num-envs", "3"],
            "a resumed run keeps its task and settings: leave out PandaReach, --num-envs, --set, or start a new run",
        ),
        (["PandaReach", "--set", "seed=3"], "'seed' is no trainer setting: --seed sets it"),
        (["PandaReach", "--require-success", "90"], "--require-success is 90, expected 0 to 1 (90 % is 0.9)"),
        (["PandaReach", "--require-success", "-1"], "--require-success is -1, expected 0 to 1"),
        (["PandaReach", "--require-success", "nan"], "--require-success is nan, expected 0 to 1"),
    ],
)
def test_bad_requests_are_explained_and_leave_nothing(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["train", *arguments, "--runs", str(tmp_path)]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_runs_where_no_folder_can_be_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["train", "PandaReach", "--runs", "/proc/x"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("manyhands train: no run can be kept in /proc/x (") and line.endswith("with --runs")


def test_a_folder_of_runs_is_no_run_but_names_one(reach: RunFolder, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", str(reach.path.parent)]) == 2
    assert f"holds runs, name one of them: {reach.path.parent}/" in capsys.readouterr().err


def test_names_without_likeness_do_not_list_everything(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["train", "xyz"]) == 2
    assert capsys.readouterr().err == "manyhands train: there is no environment 'xyz'; manyhands envs lists them\n"


def test_who_has_read_enough_hears_nothing_more() -> None:
    """`manyhands envs | head`."""
    read, write = os.pipe()
    os.close(read)
    program = "import sys; from manyhands.cli import main; sys.exit(main(['envs']))"
    with os.fdopen(write, "w") as unread:
        process = subprocess.run([sys.executable, "-c", program], stdout=unread, stderr=subprocess.PIPE, text=True)
    assert process.stderr == "" and process.returncode == 141


@pytest.mark.parametrize(
    ("package", "error"),
    [
        ("gymnasium", "KeyboardInterrupt"),
        ("rich", "KeyboardInterrupt"),
        ("rich", "ImportError('initialization failed') from KeyboardInterrupt()"),  # as pybind11 has it
    ],
)
def test_ctrl_c_during_imports_ends_silently(package: str, error: str, tmp_path: Path) -> None:
    program = f"""
import sys
class Struck:
    def find_spec(self, name, path=None, target=None):
        if name == "{package}":
            raise {error}
sys.meta_path.insert(0, Struck())
from manyhands_command import main
sys.exit(main())
"""
    command = [sys.executable, "-c", program, "train", "PandaReach", "--runs", str(tmp_path)]
    process = subprocess.run(command, capture_output=True, text=True)
    assert (process.returncode, process.stdout, process.stderr) == (130, "", "")


@pytest.mark.parametrize("error", ["KeyboardInterrupt", "ImportError('failed') from KeyboardInterrupt()"])
def test_ctrl_c_while_the_module_is_imported_ends_silently(error: str, tmp_path: Path) -> None:
    """`python -m manyhands` imports the package before any of its own code can run."""
    (tmp_path / "sitecustomize.py").write_text(f"""
import sys
class Struck:
    def find_spec(self, name, path=None, target=None):
        if name == "numpy":
            raise {error}
sys.meta_path.insert(0, Struck())
""")
    process = subprocess.run(
        [sys.executable, "-m", "manyhands", "envs"], capture_output=True, text=True,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    assert (process.returncode, process.stdout, process.stderr) == (130, "", "")


@pytest.mark.parametrize("threads", ["0", "-1", "1025", "99999"])
def test_numbers_of_threads_that_make_no_sense_are_refused(
    threads: str, reach: RunFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    for command in (["evaluate", str(reach.path)], ["train", "PandaReach"], ["train", "--resume", str(reach.path)]):
        assert cli.main([*command, "--threads", threads]) == 2
        assert f"--threads is {threads}, expected 1 to 1024" in capsys.readouterr().err


def test_resuming_without_a_checkpoint_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = RunFolder(tmp_path / "run")
    folder.make(TrainSettings("PandaReach-v3"))
    assert cli.main(["train", "--resume", str(folder.path)]) == 2
    assert "no checkpoint" in capsys.readouterr().err
    folder.checkpoint.write_bytes(b"half of a checkpo")
    assert cli.main(["train", "--resume", str(folder.path)]) == 2
    assert "checkpoint.bin" in capsys.readouterr().err


def test_names_and_overrides() -> None:
    assert resolve_env_id("PandaReach") == resolve_env_id("PandaReach-v3") == "PandaReach-v3"
    assert parse_overrides(["gamma=0.9", "hidden_layers=[8, 8]"]) == {"gamma": 0.9, "hidden_layers": [8, 8]}
    config = TrainSettings("PandaReach-v3", seed=3, overrides={"hidden_layers": [8, 8]}).trainer_config()
    assert (config.seed, config.hidden_layers) == (3, [8, 8])


def test_files_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")

    def fail(text: str, error: type[BaseException]) -> None:
        with replacing(path) as temporary:
            temporary.write_text(text)
            raise error

    for error in (OSError, KeyboardInterrupt):
        with pytest.raises(error):
            fail("half", error)
        assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("file.txt", "old")]


def test_help_teaches_by_examples(capsys: pytest.CaptureFixture[str]) -> None:
    def help_of(*command: str) -> Any:
        with pytest.raises(SystemExit, match="0"):
            cli.main([*command, "--help"])
        return capsys.readouterr().out

    assert "manyhands train PandaReach" in help_of()
    assert "--resume runs/" in help_of("train")
    assert "--episodes 10000" in help_of("evaluate")
    assert cli.main(["envs"]) == 0
    assert "PandaReachJointsDense-v3" in capsys.readouterr().out


def test_what_is_left_is_what_was_measured_while_that_holds() -> None:
    row = Row(1, 1_000, 0, 10, 0.5, 0.5, 1, 0.0, 0.0, 0.0, 100.0, 10.0)
    shown = []
    for steps, known in ((1_000, 5_000), (6_000, 5_000), (1_000, None)):
        text = io.StringIO()
        with TrainingProgress(Console(file=text), "PandaReach-v3", 20_000, known) as progress:
            progress.update(replace(row, env_steps=steps))
        shown.append(text.getvalue().split("  ")[-1].strip())
    assert shown == ["about 0:40 left", "≤ 0:23 left", "≤ 3:10 left"]


@pytest.mark.parametrize(("width", "shown"), [(120, 0), (80, 1), (60, 2), (45, 3)])
def test_a_narrow_terminal_shows_what_matters_most(width: int, shown: int) -> None:
    row = Row(1, 30_000, 100, 900, 0.97, 0.98, 5, 0.0, 0.0, 0.0, 100.0, 10.0)
    texts = [
        "3,000 steps/s  success 97%, without exploration 98.0%  about 0:06 left",
        "3,000 steps/s  success 98.0%  about 0:06 left",
        "success 98.0%  about 0:06 left",
        "about 0:06 left",
    ]
    text = io.StringIO()
    console = Console(file=text, force_terminal=True, width=width, color_system=None)
    with TrainingProgress(console, "PandaPush-v3", 100_000, 50_000) as progress:
        progress.update(row)
    last = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text.getvalue()).splitlines()[-1]
    assert last.strip().endswith(f" {texts[shown]}")
    assert len(last.strip()) <= width


def test_success_in_training_is_the_learners_own(tmp_path: Path) -> None:
    metrics = SimpleNamespace(**dict.fromkeys(field.name for field in fields(Row)), mean_return=0.0)
    for name in vars(metrics):
        setattr(metrics, name, 0)
    metrics.success_rate = 1.0  # of the script, while it alone acts
    known = []
    recorder = Recorder(RunFolder(tmp_path), num_envs=16)
    for gradient_steps, episodes in ((0, 16), (0, 64), (8, 80), (16, 179), (24, 180)):
        metrics.gradient_steps, metrics.episodes = gradient_steps, episodes
        known.append(not math.isnan(recorder.add(cast(Any, metrics), 0.1).success_rate))
    assert known == [False, False, False, False, True]


def test_a_run_by_a_recipe_takes_what_was_measured() -> None:
    recipe = find_recipe("PandaReach-v3")
    assert recipe is not None and recipe.measured is not None
    assert expected(recipe.settings(seed=3)) == recipe.measured
    assert expected(recipe.settings(overrides={"gamma": 0.9})) is None
    assert expected(recipe.settings(num_envs=32)) is None
