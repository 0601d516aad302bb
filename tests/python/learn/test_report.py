"""manyhands.learn: what a user sees of a training while it runs."""

from pathlib import Path
from typing import Any

import gymnasium
import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

import manyhands  # noqa: F401  registers the environments
from manyhands.learn import PPO, Model
from manyhands.learn.report import line

SMALL: dict[str, Any] = {"policy_kwargs": {"net_arch": [16]}, "n_steps": 32, "batch_size": 32}


class Arrives(gymnasium.Wrapper[Any, Any, Any, Any]):
    """An environment without goals that says when it succeeds."""

    def step(self, action: Any) -> Any:
        observation, reward, terminated, truncated, info = super().step(action)
        return observation, reward, terminated, truncated, {**info, "is_success": bool(terminated)}


@pytest.mark.parametrize("bar", [False, True])
def test_there_is_no_success_where_the_environment_has_none(capfd: Any, tmp_path: Path, bar: bool) -> None:
    model = PPO("MlpPolicy", "CartPole-v1", verbose=1, tensorboard_log=tmp_path, **SMALL)
    model.learn(512, progress_bar=bar)
    shown = capfd.readouterr().out
    assert "mean return" in shown
    assert "success" not in shown
    events = EventAccumulator(str(tmp_path / "PPO_1")).Reload()
    assert "rollout/ep_rew_mean" in events.Tags()["scalars"]
    assert "rollout/success_rate" not in events.Tags()["scalars"]


@pytest.mark.parametrize("env", ["PandaReach-v3", Arrives(gymnasium.make("CartPole-v1"))])
def test_success_is_shown_where_there_is_one(env: Any) -> None:
    model = PPO("MultiInputPolicy", env, **SMALL).learn(2048)
    assert "success" in line(model)


@pytest.mark.parametrize("bar", [False, True])
def test_the_last_line_comes_once(capfd: Any, bar: bool) -> None:
    PPO("MlpPolicy", "CartPole-v1", verbose=1, **SMALL).learn(512, progress_bar=bar)
    assert capfd.readouterr().out.count("mean return") == 1


@pytest.mark.parametrize("width", [50, 80, 120])
def test_the_bar_fits_the_terminal(capfd: Any, monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    PPO("MlpPolicy", "CartPole-v1", **SMALL).learn(512, progress_bar=True)
    shown = capfd.readouterr().out.strip()
    assert len(shown) <= width and shown.endswith("0:00 left")
    assert width < 80 or "mean return" in shown


def test_a_training_that_a_callback_ends_shows_where_it_came_to(capfd: Any) -> None:
    def callback(model: Model) -> bool:
        return model.num_timesteps < 40

    PPO("MlpPolicy", "CartPole-v1", verbose=1, **SMALL).learn(512, callback=callback)
    assert "40 steps" in capfd.readouterr().out


def test_before_the_first_episode_there_is_no_mean() -> None:
    assert "mean return -" in line(PPO("MlpPolicy", "Pendulum-v1", **SMALL).learn(10))
