"""Policies become those of Stable-Baselines3 and back, and act the same."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

import torch
from sb3_contrib import TQC
from stable_baselines3 import DDPG, PPO, SAC, TD3
from stable_baselines3.common.vec_env import VecNormalize

from manyhands._core.envs import make_env_batch
from manyhands._core.learn import Trainer, TrainerConfig
from manyhands.envs.sb3 import make_sb3
from manyhands.training.evaluation import PolicyFile
from manyhands.training.policy_file import save_policy
from manyhands.training.sb3 import from_sb3, to_sb3

ENV_ID = "PandaPush-v3"


def observations(count: int = 300) -> dict[str, np.ndarray]:
    """Rows as Push has them, and some far outside."""
    rng = np.random.default_rng(0)
    sizes = {"observation": 18, "achieved_goal": 3, "desired_goal": 3}
    return {name: rng.normal(scale=2, size=(count, size)).astype(np.float32) for name, size in sizes.items()}


def assert_acts_as(path: Path, model: Any) -> None:
    obs = observations()
    seen = obs if (statistics := model.get_vec_normalize_env()) is None else statistics.normalize_obs(obs)
    expected = model.predict(seen, deterministic=True)[0]
    np.testing.assert_allclose(PolicyFile(path)(obs), expected, atol=2e-6)
    assert expected.std() > 0.01


MODELS: dict[str, tuple[Any, dict[str, Any]]] = {
    "TD3": (TD3, {"policy_kwargs": {"net_arch": [32, 24]}}),
    "TD3 without hidden layers": (TD3, {"policy_kwargs": {"net_arch": []}}),
    "DDPG": (DDPG, {"policy_kwargs": {"net_arch": [32]}}),
    "SAC": (SAC, {"policy_kwargs": {"net_arch": [32, 24]}}),
    "SAC with tanh": (SAC, {"policy_kwargs": {"net_arch": [32, 24], "activation_fn": torch.nn.Tanh}}),
    "SAC with gSDE": (SAC, {"use_sde": True, "policy_kwargs": {"net_arch": [32, 24]}}),
    "TQC": (TQC, {"policy_kwargs": {"net_arch": [32, 24]}}),
}


@pytest.mark.parametrize("name", MODELS)
def test_a_file_from_sb3_acts_as_the_model(name: str, tmp_path: Path) -> None:
    kind, arguments = MODELS[name]
    model = kind("MultiInputPolicy", make_sb3(ENV_ID), seed=0, buffer_size=100, device="cpu", **arguments)
    from_sb3(model, ENV_ID, tmp_path / "policy.onnx")
    assert_acts_as(tmp_path / "policy.onnx", model)
    assert PolicyFile(tmp_path / "policy.onnx").env_id == ENV_ID


@pytest.mark.parametrize("keys", [None, ["observation"]])
def test_statistics_of_vec_normalize_go_along(keys: list[str] | None, tmp_path: Path) -> None:
    env = VecNormalize(make_sb3(ENV_ID, 4), norm_obs_keys=keys, clip_obs=1.5)
    model = TD3("MultiInputPolicy", env, seed=0, learning_starts=100, buffer_size=1000, device="cpu")
    model.learn(80)
    assert (env.obs_rms["observation"].var != 1).all()
    from_sb3(model, ENV_ID, tmp_path / "policy.onnx")
    assert_acts_as(tmp_path / "policy.onnx", model)


@pytest.mark.parametrize(
    ("algorithm", "activation", "differences"),
    [("TD3", "relu", []), ("TD3", "relu", [6, 0, 3, 9]), ("SAC", "tanh", [])],
)
def test_a_policy_of_ours_acts_the_same_in_sb3(
    algorithm: str, activation: str, differences: list[int], tmp_path: Path
) -> None:
    config = TrainerConfig()
    config.algorithm, config.activation = algorithm, activation
    config.hidden_layers, config.differences = [24, 16], differences
    trainer = Trainer(make_env_batch(ENV_ID, 32), None, config)
    trainer.advance(100)
    path = tmp_path / "policy.onnx"
    save_policy(trainer.policy(), ENV_ID, path)
    model = to_sb3(path, make_sb3(ENV_ID), buffer_size=100)
    assert_acts_as(path, model)
    model.save(tmp_path / "model")
    assert_acts_as(path, TD3.load(tmp_path / "model"))
    from_sb3(model, ENV_ID, str(tmp_path / "again.onnx"))
    assert_acts_as(tmp_path / "again.onnx", model)


def test_what_cannot_be_converted_is_told(tmp_path: Path) -> None:
    path = tmp_path / "policy.onnx"
    small = {"buffer_size": 100, "device": "cpu"}
    with pytest.raises(ValueError, match="PPO has no deterministic actor"):
        from_sb3(PPO("MultiInputPolicy", make_sb3(ENV_ID), device="cpu"), ENV_ID, path)
    with pytest.raises(ValueError, match="expected a goal environment's observation, achieved_goal, desired_goal"):
        from_sb3(TD3("MlpPolicy", gymnasium.make("Pendulum-v1"), **small), ENV_ID, path)
    odd = {"policy_kwargs": {"activation_fn": torch.nn.LeakyReLU}}
    with pytest.raises(ValueError, match="the actor's layer LeakyReLU cannot be converted"):
        from_sb3(TD3("MultiInputPolicy", make_sb3(ENV_ID), **small, **odd), ENV_ID, path)
    assert not path.exists()

    model = TD3("MultiInputPolicy", make_sb3(ENV_ID), **small)
    from_sb3(model, ENV_ID, path)
    with pytest.raises(ValueError, match=r"is no policy that a trainer of ours made.*: its operations are Concat"):
        to_sb3(path, make_sb3(ENV_ID))
    config = TrainerConfig()
    config.algorithm = "PPO"
    save_policy(Trainer(make_env_batch(ENV_ID, 16), None, config).policy(), ENV_ID, path)
    with pytest.raises(ValueError, match="is no policy that reaches goals and ends with tanh"):
        to_sb3(path, make_sb3(ENV_ID))
    save_policy(Trainer(make_env_batch(ENV_ID, 16), None, TrainerConfig()).policy(), ENV_ID, path)
    with pytest.raises(ValueError, match=r"the policy takes .*'observation': \(18,\).* the environment gives"):
        to_sb3(path, make_sb3("PandaReach-v3"))
    path.write_bytes(b"no graph")
    with pytest.raises(ValueError, match="cannot be read as a policy"):
        to_sb3(path, make_sb3(ENV_ID))


def test_a_policy_that_sees_how_a_cube_is_to_be_turned_is_refused(tmp_path: Path) -> None:
    config = TrainerConfig()
    config.cube_rotation = 10
    path = tmp_path / "policy.onnx"
    save_policy(Trainer(make_env_batch("PandaFlip-v3", 4), None, config).policy(), "PandaFlip-v3", path)
    with pytest.raises(ValueError, match="sees a cube's rotation"):
        to_sb3(path, make_sb3("PandaFlip-v3"))
