"""A policy that sees does what PyTorch makes of its weights, in a file and in the trainer."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from manyhands._core.envs import make_env_batch, make_expert
from manyhands._core.learn import Policy, Trainer, TrainerConfig
from manyhands.envs.cameras import eyes
from manyhands.envs.registration import make_vector_env
from manyhands.training.evaluation import PolicyFile
from manyhands.training.policy_file import save_policy

ENV_ID = "PandaPush-v3"
CAMERAS = {"front": {"width": 60, "height": 48}, "wrist": {"width": 60, "height": 48}}


def trained() -> Policy:
    config = TrainerConfig()
    config.algorithm, config.cloning_weight, config.cloning_filter = "DAgger", 1.0, False
    config.hidden_layers, config.channels, config.frame_stack = [24, 16], [8, 12], 3
    config.batch_size, config.warmup_transitions = 16, 64
    config.expert_rate, config.exploration_noise = 0.5, 0.5
    batch = make_env_batch(ENV_ID, 8)
    trainer = Trainer(batch, None, config, make_expert(ENV_ID), eyes(batch, CAMERAS))
    trainer.advance(20)
    assert trainer.metrics().gradient_steps > 50
    return trainer.policy()


def by_torch(policy: Policy, stacks: list[np.ndarray], observation: np.ndarray) -> np.ndarray:
    """stacks: (n, stack, height, width, 3) of each camera."""
    parts = []
    for stack, layers in zip(stacks, policy.eyes, strict=True):
        x = torch.tensor(stack).float() / 255 - 0.5
        x = x.permute(0, 1, 4, 2, 3).flatten(1, 2)
        for weight, bias, stride in layers:
            kernel = torch.tensor(weight).permute(0, 1, 4, 2, 3).flatten(1, 2)
            x = torch.relu(torch.nn.functional.conv2d(x, kernel, torch.tensor(bias), stride=stride))
        parts.append(x.permute(0, 2, 3, 1).flatten(1))
    own = torch.tensor(observation[:, : policy.observation_dim])
    z = ((own - torch.tensor(policy.mean)) * torch.tensor(policy.scale)).clamp(-policy.clip, policy.clip)
    x = torch.cat([*parts, z], dim=1)
    for i, (weight, bias) in enumerate(policy.layers):
        x = torch.nn.functional.linear(x, torch.tensor(weight), torch.tensor(bias))
        if i + 1 < len(policy.layers):
            x = torch.relu(x)
    return torch.tanh(x).numpy()


def test_a_file_does_what_pytorch_makes_of_its_weights(tmp_path: Path) -> None:
    policy = trained()
    save_policy(policy, ENV_ID, tmp_path / "policy.onnx", CAMERAS)
    file = PolicyFile(tmp_path / "policy.onnx")
    env = make_vector_env(ENV_ID, 6, cameras=file.cameras)
    seen = [env.reset(seed=3)[0]]
    action = file(seen[0])
    for _ in range(4):
        stacks = [np.stack([one[name] for one in ([seen[0]] * 3 + seen)[-3:][::-1]], axis=1) for name in CAMERAS]
        np.testing.assert_allclose(action, by_torch(policy, stacks, seen[-1]["observation"]), atol=2e-5)
        seen.append(env.step(np.full((6, 3), 0.7, np.float32))[0])
        action = file(seen[-1])
    assert action.std() > 0.01
