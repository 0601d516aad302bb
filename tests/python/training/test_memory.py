"""What a training takes of memory is told before it is taken, and refused where it is not there."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from manyhands.training import memory
from manyhands.training.memory import free_memory, in_gigabytes, require_memory
from manyhands.training.settings import TrainSettings

REACH = "PandaReach-v3"


def refusal(settings: TrainSettings, runs: int = 1) -> str:
    with pytest.raises(ValueError, match="of memory") as caught:
        require_memory(settings, runs)
    return str(caught.value)


def most(text: str) -> int:
    (found,) = re.findall(r"at most ([\d,]+) fit", text)
    return int(found.replace(",", ""))


@pytest.mark.parametrize("runs", [1, 2])
def test_the_number_that_is_told_fits_and_not_many_more(runs: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 2e9)
    few = {"evaluation_episodes": 1}
    for make in (
        lambda n: TrainSettings(REACH, num_envs=n),
        lambda n: TrainSettings(REACH, num_envs=1, overrides=few | {"replay_capacity": n}),
        lambda n: TrainSettings(REACH, num_envs=1, overrides={"evaluation_episodes": n}),
    ):
        told = most(refusal(make(10**9), runs))
        assert 0.8 * 2e9 < runs * require_memory(make(told), runs) <= 2e9
        assert most(refusal(make(int(1.2 * told)), runs)) == told


def test_what_lies_in_a_file_or_elsewhere_takes_none(tmp_path: Path) -> None:
    capacity = {"replay_capacity": 2 * 10**9}
    assert "--set replay_folder" in refusal(TrainSettings(REACH, overrides=capacity))
    require_memory(TrainSettings(REACH, overrides=capacity | {"replay_folder": str(tmp_path)}))
    require_memory(TrainSettings(REACH, overrides=capacity | {"algorithm": "PPO", "hindsight_fraction": 0}))
    require_memory(TrainSettings(REACH, num_envs=10**8, workers=100))


def test_pictures_count() -> None:
    cameras = {"front": {}, "wrist": {"width": 42, "height": 21}}
    overrides = {"algorithm": "DAgger", "cloning_weight": 1.0, "cloning_filter": False, "replay_capacity": 10**4}
    blind, seeing = (require_memory(TrainSettings(REACH, overrides=overrides, cameras=each)) for each in ({}, cameras))
    assert seeing - blind == pytest.approx(10**4 * 3 * (84 * 84 + 42 * 21), rel=0.01)


def test_free_memory() -> None:
    assert 1e7 < free_memory() < 1e14
    assert [in_gigabytes(size) for size in (4e8, 9.94e9, 1.12e12)] == ["0.4 GB", "9.9 GB", "1,120 GB"]


@pytest.mark.parametrize("env_id", [REACH, "PandaStack-v3"])
def test_a_training_takes_what_was_told(env_id: str, tmp_path: Path) -> None:
    """By the peak of a process of its own, to a quarter."""
    program = f"""
from pathlib import Path
import manyhands.training.curve, manyhands.training.events, manyhands.training.policy_file  # libraries, not worlds
from manyhands import cli
from manyhands.training.memory import require_memory
from manyhands.training.settings import TrainSettings

def peak():
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM:"))
    return 1024 * int(line.split()[1])

settings = dict(replay_capacity=10000, updates_per_iteration=1, batch_size=8)
arguments = "--num-envs 21000 --max-steps 42000 --episodes 1 --threads 1".split()
for name, value in settings.items():
    arguments += "--set", f"{{name}}={{value}}"
told = require_memory(TrainSettings({env_id!r}, num_envs=21000, overrides=settings))
before = peak()
assert cli.main(["train", {env_id!r}, *arguments, "--runs", {str(tmp_path)!r}]) == 0
print("took", (peak() - before) / told)
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, result.stderr
    assert re.search(r"^Making 21,000 worlds, which takes about 0\.\d GB of memory$", result.stdout, re.MULTILINE)
    assert 0.75 < float(result.stdout.rpartition("took ")[2]) < 1.25
