"""A training that is killed, at whatever moment, and resumed ends with the bits of one that was left alone.

MANYHANDS_KILLS=20 kills each run 20 times.
"""

import csv
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import onnx
import pytest

from manyhands import cli
from manyhands.training.run_folder import RunFolder

KILLS = int(os.environ.get("MANYHANDS_KILLS", "4"))
STEPS = 30_000 if KILLS > 4 else 12_800

COMMON = ("--num-envs", "16", "--episodes", "20", "--seed", "3", "--threads", "1", "--set", "stop_streak=0")
TD3 = (*COMMON, "--set", "updates_per_iteration=2", "--set", "num_critics=2", "--set", "evaluation_interval=40")
PPO = (
    *COMMON,
    *("--set", "algorithm=PPO", "--set", "rollout_steps=16", "--set", "batch_size=64", "--set", "hindsight_fraction=0"),
)

# Checkpoints as often as can be, so that each life of a run gets somewhere.
PROGRAM = """
import sys
from manyhands import cli
from manyhands.training import run
run._SECONDS_PER_CHECKPOINT = 0.0, 0.0
sys.exit(cli.main(sys.argv[1:]))
"""


def start(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", PROGRAM, "train", *arguments]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def steps_done(folder: RunFolder) -> int:
    if not folder.metrics.is_file():
        return 0
    with folder.metrics.open(newline="") as file:
        return int(([{"env_steps": 0}, *csv.DictReader(file)])[-1]["env_steps"])


def kill_somewhere(process: subprocess.Popen[str], folder: RunFolder, moment: float) -> bool:
    """Kills it `moment` seconds after it has got further than it was. False if it ended before."""
    begun = steps_done(folder)
    deadline = time.monotonic() + 120
    while steps_done(folder) <= begun and process.poll() is None:
        assert time.monotonic() < deadline, "it does not get anywhere"
        time.sleep(0.001)
    time.sleep(moment)
    process.send_signal(signal.SIGKILL)
    _, err = process.communicate()
    assert process.returncode in (0, -signal.SIGKILL), err
    return process.returncode != 0


@pytest.mark.parametrize("settings", [TD3, PPO], ids=["TD3", "PPO"])
def test_a_killed_run_ends_with_the_same_bits(settings: tuple[str, ...], tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    command = ["PandaReach", *settings, "--max-steps", str(STEPS)]
    assert cli.main(["train", *command, "--runs", str(whole)]) == 0
    (expected,) = (RunFolder(path) for path in whole.iterdir())

    seed = random.SystemRandom().randrange(2**32)
    print(f"random.Random({seed})")
    moments = random.Random(seed)
    runs = tmp_path / "runs"
    process = start(*command, "--runs", str(runs))
    while not list(runs.glob("*/checkpoint.bin")):
        assert process.poll() is None, process.communicate()
        time.sleep(0.001)
    (folder,) = (RunFolder(path) for path in runs.iterdir())
    killed = 0
    while killed < KILLS and kill_somewhere(process, folder, moments.uniform(0, 0.1)):
        killed += 1
        process = start("--resume", str(folder.path))
    assert killed == KILLS, f"the run ended after {killed} kills: give it more steps"
    _, err = process.communicate()
    assert process.returncode == 0, err

    weights = [[one.raw_data for one in onnx.load(run.policy).graph.initializer] for run in (folder, expected)]
    assert weights[0] == weights[1]
    assert folder.checkpoint.read_bytes() == expected.checkpoint.read_bytes(), "all that the run would go on from"
    assert folder.evaluation.read_text() == expected.evaluation.read_text()
    rows = [list(csv.DictReader(run.metrics.open(newline=""))) for run in (folder, expected)]
    assert rows[0][-1]["env_steps"] == rows[1][-1]["env_steps"]
    steps = [int(row["env_steps"]) for row in rows[0]]
    assert steps == sorted(set(steps))
    left = [path.name for path in folder.path.iterdir() if path.name.startswith(".") or ".part" in path.name]
    assert len(left) <= KILLS, "no more than what the last breath of each was writing"
