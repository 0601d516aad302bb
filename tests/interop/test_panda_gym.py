"""Policies travel between manyhands and the real panda-gym, on the real PyBullet, and succeed as often there."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("panda_gym")
pytest.importorskip("stable_baselines3")

import pybullet
import torch
from gymnasium.wrappers import TimeLimit
from panda_gym.envs import panda_tasks
from stable_baselines3 import TD3, HerReplayBuffer
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.vec_env import DummyVecEnv

from manyhands import cli
from manyhands.training.evaluation import PolicyFile, evaluate
from manyhands.training.sb3 import from_sb3

THERE, HERE, APART = 200, 1000, 0.05  # episodes in panda-gym and here, and by how much success may differ


@contextmanager
def quiet() -> Iterator[None]:
    """PyBullet tells every new simulation's colours."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


@contextmanager
def real(task: str) -> Iterator[Any]:
    """panda-gym's own environment."""
    with quiet():
        env = TimeLimit(getattr(panda_tasks, f"Panda{task}Env")(), 50)
    assert "manyhands" not in pybullet.__file__
    try:
        yield env
    finally:
        env.close()


def success_there(task: str, act: Callable[[dict[str, np.ndarray]], np.ndarray]) -> float:
    with real(task) as env:
        successes = 0
        for episode in range(THERE):
            observation, info = env.reset(seed=10**6 + episode)
            ended = False
            while not ended:
                observation, _, terminated, truncated, info = env.step(act(observation))
                ended = terminated or truncated
            successes += bool(info["is_success"])
        return successes / THERE


@pytest.mark.parametrize("task", ["Reach", "Push", "PickAndPlace"])
def test_a_policy_trained_here_succeeds_in_panda_gym(
    task: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["train", f"Panda{task}", "--seed", "0", "--episodes", str(HERE), "--runs", str(tmp_path)]) == 0
    (folder,) = tmp_path.iterdir()
    policy = PolicyFile(folder)
    here = evaluate(policy, f"Panda{task}-v3", HERE, 10**6).success_rate
    there = success_there(task, policy)
    with capsys.disabled():
        print(f"\n  {task}: {here:.1%} of {HERE} episodes here, {there:.1%} of {THERE} in panda-gym", end="")
    assert there == pytest.approx(here, abs=APART)
    assert here > 0.95


def test_a_policy_trained_in_panda_gym_succeeds_here(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    torch.set_num_threads(1)  # the networks are small
    with real("Reach") as env:
        model = TD3(
            "MultiInputPolicy", DummyVecEnv([lambda: env]), seed=0, device="cpu", learning_starts=500, gamma=0.95,
            action_noise=NormalActionNoise(np.zeros(3), 0.2 * np.ones(3)), policy_kwargs={"net_arch": [64, 64]},
            replay_buffer_class=HerReplayBuffer, buffer_size=10_000,
        )  # fmt: skip
        model.learn(3000)
    there = success_there("Reach", lambda observation: model.predict(observation, deterministic=True)[0])
    from_sb3(model, "PandaReach-v3", tmp_path / "policy.onnx")
    here = evaluate(PolicyFile(tmp_path / "policy.onnx"), "PandaReach-v3", HERE, 10**6).success_rate
    with capsys.disabled():
        print(f"\n  Reach: {there:.1%} of {THERE} episodes in panda-gym, {here:.1%} of {HERE} here", end="")
    assert here == pytest.approx(there, abs=APART)
    assert there > 0.95
