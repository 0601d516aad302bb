"""manyhands.learn takes what programs for Stable-Baselines3 write, or says what to write instead."""

import enum
import re
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import manyhands  # noqa: F401  registers the environments
from manyhands import learn
from manyhands.learn import DDPG, PPO, SAC, TD3, TQC
from manyhands.training import memory

SMALL: dict[str, Any] = {"policy_kwargs": {"net_arch": [8]}, "batch_size": 8}


class HerReplayBuffer:
    """Known by its name alone: Stable-Baselines3 is not needed."""


class ReplayBuffer:
    pass


class GoalSelectionStrategy(enum.Enum):
    FUTURE = 0
    FINAL = 1


class NormalActionNoise:
    def __init__(self, mean: Any, sigma: Any) -> None:
        self._mu, self._sigma = mean, sigma


TAKEN: list[tuple[Any, dict[str, Any], dict[str, Any]]] = [
    (PPO, {"device": "auto", "use_sde": False, "clip_range_vf": None, "target_kl": None}, {}),
    (PPO, {"normalize_advantage": True, "stats_window_size": 100, "_init_setup_model": True}, {}),
    (PPO, {"policy_kwargs": {"net_arch": {"pi": [8], "vf": [8]}, "log_std_init": -1}}, {"initial_std": np.exp(-1)}),
    (PPO, {"n_steps": 64.0, "batch_size": np.int64(32)}, {"rollout_steps": 64, "batch_size": 32}),
    (SAC, {"gradient_steps": -1, "n_envs": 3}, {"updates_per_iteration": 3}),
    (SAC, {"gradient_steps": -1, "train_freq": (1, "episode"), "n_envs": 3}, {"updates_per_iteration": 3}),
    (SAC, {"gradient_steps": 8, "train_freq": (4, "step")}, {"updates_per_iteration": 2}),
    (SAC, {"buffer_size": 1e5, "learning_starts": 1e3}, {"replay_capacity": 100_000, "warmup_transitions": 1000}),
    (SAC, {"action_noise": None, "optimize_memory_usage": False, "target_update_interval": 1}, {}),
    (SAC, {"policy_kwargs": {"net_arch": [8], "n_critics": 3}}, {"num_critics": 3}),
    (TQC, {"policy_kwargs": {"n_quantiles": 5}}, {"num_quantiles": 5, "dropped_quantiles": 2}),
    (TQC, {"ent_coef": "auto"}, {"temperature": 1.0}),
    (TQC, {"env": "PandaReach-v3"}, {"temperature": 0.1, "hindsight_fraction": 0.8}),
    (SAC, {"env": "PandaReach-v3", "ent_coef": "auto_0.5"}, {"temperature": 0.5}),
    (SAC, {"env": "PandaReach-v3", "replay_buffer_class": ReplayBuffer}, {"hindsight_fraction": 0.0}),
    (TD3, {"action_noise": NormalActionNoise(np.zeros(3), 0.2 * np.ones(3))}, {"exploration_noise": 0.2}),
    (DDPG, {"action_noise": None}, {"exploration_noise": 0.0}),
    (
        DDPG,
        {
            "env": "PandaReach-v3",
            "replay_buffer_class": HerReplayBuffer,
            "replay_buffer_kwargs": {"n_sampled_goal": 9, "goal_selection_strategy": "future"},
        },
        {"hindsight_fraction": 0.9},
    ),
    (
        TD3,
        {
            "env": "PandaReach-v3",
            "replay_buffer_class": "HerReplayBuffer",
            "replay_buffer_kwargs": {"goal_selection_strategy": GoalSelectionStrategy.FUTURE, "copy_info_dict": True},
        },
        {"hindsight_fraction": 0.8},
    ),
]


@pytest.mark.parametrize(("algorithm", "arguments", "settings"), TAKEN)
def test_what_means_the_same_is_taken(
    algorithm: Any, arguments: dict[str, Any], settings: dict[str, Any], tmp_path: Path
) -> None:
    model = algorithm("MlpPolicy", **({"env": "Pendulum-v1"} | arguments))
    assert {name: model._settings[name] for name in settings} == pytest.approx(settings)
    model.save(tmp_path / "model")


REFUSED: list[tuple[Any, dict[str, Any], str]] = [
    (PPO, {"device": "cuda"}, "device is 'cuda', expected 'auto' or 'cpu': networks run on the processor"),
    (PPO, {"target_kl": 0.01}, "target_kl is 0.01, expected None: .* set n_epochs or learning_rate lower"),
    (PPO, {"clip_range_vf": 0.2}, "clip_range_vf is 0.2, expected None: values are not clipped"),
    (PPO, {"action_noise": None}, "PPO has no argument action_noise"),
    (PPO, {"learning_rat": 1}, "PPO has no argument learning_rat; did you mean learning_rate"),
    (PPO, {"n_steps": 0}, "^n_steps is 0, expected 1 or more"),
    (PPO, {"n_steps": 64.5}, "^n_steps is 64.5, expected a whole number"),
    (PPO, {"batch_size": 33}, "^batch_size is 33, it must be even and at least 2"),
    (PPO, {"batch_size": "big"}, "^batch_size is 'big', expected a whole number"),
    (PPO, {"n_steps": 10}, "^batch_size is 64, but 1 worlds make 10 transitions in n_steps of 10"),
    (PPO, {"learning_rate": 2.0}, "^learning_rate is 2, it must be in"),
    (PPO, {"ent_coef": -1}, "^ent_coef is -1, it must be in"),
    (PPO, {"policy_kwargs": {"net_arch": []}}, r"^net_arch is \[\], expected the units"),
    (PPO, {"policy_kwargs": [64]}, r"policy_kwargs is \[64\], expected a dict"),
    (SAC, {"replay_buffer_kwargs": 4}, "replay_buffer_kwargs is 4, expected a dict"),
    (SAC, {"replay_buffer_class": "HerReplayBuffer"}, "'HerReplayBuffer', but Pendulum-v1 has no goals: leave it out"),
    (SAC, {"use_sde": True}, "use_sde is True, expected False"),
    (SAC, {"action_noise": 0.1}, "action_noise is 0.1, expected None: actions are drawn"),
    (SAC, {"gradient_steps": -2}, "^gradient_steps is -2, expected -1 or more"),
    (SAC, {"gradient_steps": 1.5}, "^gradient_steps is 1.5, expected a whole number"),
    (SAC, {"train_freq": (1, "episode")}, "training follows every step here, so gradient_steps must be -1"),
    (SAC, {"tau": 2}, "^tau is 2, it must be in"),
    (SAC, {"learning_starts": 2e6}, "^learning_starts is 2000000, it must be at least 1 and at most buffer_size"),
    (SAC, {"ent_coef": None}, "^ent_coef is None, expected a number"),
    (
        SAC,
        {"learning_starts": 1e12},
        r"^learning_starts is 1000000000000, expected a whole number from .* to 2147483647",
    ),
    (PPO, {"batch_size": 1e12}, r"^batch_size is 1000000000000, expected a whole number from .* to 2147483647"),
    (TQC, {"n_critics": 0}, "^n_critics is 0"),
    (TQC, {"use_sde_at_warmup": True}, "use_sde_at_warmup is True"),
    (TD3, {"target_update_interval": 2}, "target_update_interval is 2, expected 1: .* set tau lower"),
    (TD3, {"action_noise": "much"}, "action_noise is 'much', expected the standard deviation"),
    (TD3, {"action_noise": NormalActionNoise(np.ones(1), np.ones(1))}, "expected a mean of 0"),
    (DDPG, {"replay_buffer_class": dict}, "replay_buffer_class is 'dict', expected 'HerReplayBuffer'"),
    (DDPG, {"replay_buffer_kwargs": {"online_sampling": True}}, "replay_buffer_kwargs has no 'online_sampling'"),
    (DDPG, {"replay_buffer_kwargs": {"n_sampled_goal": 1.5}}, "n_sampled_goal is 1.5, expected a whole number"),
    (DDPG, {"replay_buffer_kwargs": {"goal_selection_strategy": GoalSelectionStrategy.FINAL}}, "expected 'future'"),
]


@pytest.mark.parametrize(("algorithm", "arguments", "says"), REFUSED)
def test_what_does_not_is_said(algorithm: Any, arguments: dict[str, Any], says: str) -> None:
    with pytest.raises((TypeError, ValueError), match=says):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)


@pytest.mark.parametrize(
    ("algorithm", "name", "hint"),
    [(SAC, "buffer_size", "; a file holds more: give replay_folder"), (PPO, "n_steps", "")],
)
def test_what_has_no_room_in_memory_is_refused(
    algorithm: Any, name: str, hint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "free_memory", lambda: 1e9)
    pattern = rf"^{name} is 1,000,000,000,000, which takes .* and 1.0 GB are free: at most ([\d,]+) fit{hint}$"
    with pytest.raises(ValueError, match=pattern) as refusal:
        algorithm("MlpPolicy", "Pendulum-v1", **{name: 1e12})
    (most,) = re.findall(r"at most ([\d,]+) fit", str(refusal.value))
    assert 1e7 < int(most.replace(",", "")) < 1e8, "a step has 7 to 10 numbers"


SHARED = "learning_rate=3e-4 gamma=0.99 stats_window_size=100 tensorboard_log=None policy_kwargs=None verbose=0"
SHARED += " seed=None device='auto' _init_setup_model=True"
OFF_POLICY = (
    "buffer_size=1_000_000 learning_starts=100 batch_size=256 tau=0.005 train_freq=1 gradient_steps=1 n_steps=1"
)
OFF_POLICY += " action_noise=None replay_buffer_class=None replay_buffer_kwargs=None optimize_memory_usage=False"
SOFT = "ent_coef='auto' target_update_interval=1 target_entropy='auto' use_sde=False sde_sample_freq=-1"
SOFT += " use_sde_at_warmup=False"
ALL: list[tuple[Any, str]] = [
    (
        PPO,
        "n_steps=2048 batch_size=64 n_epochs=10 gae_lambda=0.95 clip_range=0.2 clip_range_vf=None "
        "normalize_advantage=True ent_coef=0.0 vf_coef=0.5 max_grad_norm=0.5 use_sde=False sde_sample_freq=-1 "
        "rollout_buffer_class=None rollout_buffer_kwargs=None target_kl=None",
    ),
    (SAC, f"{OFF_POLICY} {SOFT}"),
    (TQC, f"{OFF_POLICY} {SOFT} top_quantiles_to_drop_per_net=2"),
    (TD3, f"{OFF_POLICY} policy_delay=2 target_policy_noise=0.2 target_noise_clip=0.5"),
    (DDPG, OFF_POLICY),
]


@pytest.mark.parametrize(("algorithm", "own"), ALL)
def test_every_argument_of_version_2_9_is_known_with_its_default(algorithm: Any, own: str) -> None:
    arguments = eval(f"dict({', '.join(f'{SHARED} {own}'.split())})")
    algorithm("MlpPolicy", "Pendulum-v1", **arguments)
    guide = (Path(__file__).resolve().parents[3] / "docs" / "learn.md").read_text()
    assert not [name for name in arguments if f"`{name}" not in guide], "the guide says what becomes of each"


def test_steps_may_be_a_whole_float() -> None:
    model = PPO("MlpPolicy", "CartPole-v1", n_steps=8, **SMALL).learn(1e2, log_interval=4, reset_num_timesteps=True)
    assert model.num_timesteps == 100
    with pytest.raises(ValueError, match=r"total_timesteps is 1.5, expected a whole number"):
        model.learn(1.5)
    with pytest.raises(ValueError, match="reset_num_timesteps is True"):
        model.learn(10, reset_num_timesteps=True)
    with pytest.raises(TypeError, match="callback is a list, expected a function that takes the model"):
        model.learn(10, callback=[])  # pyright: ignore[reportArgumentType]


def test_without_a_seed_one_is_drawn() -> None:
    first, second = (PPO("MlpPolicy", "CartPole-v1", n_steps=8, seed=None, **SMALL) for _ in range(2))
    assert first.seed != second.seed


def test_a_model_goes_on_in_another_environment() -> None:
    model = SAC("MlpPolicy", "Pendulum-v1", **SMALL).learn(300)
    before = model.predict(np.ones(3), deterministic=True)[0]
    model.set_env(gymnasium.make("Pendulum-v1", g=1.0))
    np.testing.assert_array_equal(model.predict(np.ones(3), deterministic=True)[0], before)
    model.learn(300)
    assert model.num_timesteps == 600
    with pytest.raises(ValueError, match=r"^the model, of Pendulum-v1, does not fit PandaReach-v3: its task"):
        model.set_env("PandaReach-v3")
    model.learn(10)


def test_a_saved_model_is_loaded_on_the_processor(tmp_path: Path) -> None:
    PPO("MlpPolicy", "CartPole-v1", n_steps=8, **SMALL).save(tmp_path / "model")
    PPO.load(tmp_path / "model", device="cpu")
    with pytest.raises(ValueError, match="device is 'cuda', expected 'auto' or 'cpu'"):
        PPO.load(tmp_path / "model", device="cuda")


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("HerReplayBuffer", "HerReplayBuffer: where there are goals it is the default"),
        ("DQN", "DQN: PPO learns choices"),
        ("A2C", "A2C: use PPO"),
        ("DreamerV3", "DreamerV3$"),
    ],
)
def test_names_of_its_modules_say_what_to_write(name: str, says: str) -> None:
    with pytest.raises(AttributeError, match=f"^manyhands.learn has no {says}"):
        getattr(learn, name)


@pytest.mark.parametrize("name", ["get_env", "save_replay_buffer", "logger"])
def test_methods_that_are_missing_say_what_to_do(name: str) -> None:
    with pytest.raises(AttributeError, match=f"PPO has no {name}: .*"):
        getattr(PPO("MlpPolicy", "CartPole-v1", n_steps=8, **SMALL), name)
