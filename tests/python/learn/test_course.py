"""manyhands.learn: learning rates by a schedule, and TensorBoard's events."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

import manyhands  # noqa: F401  registers the environments
from manyhands.learn import DDPG, PPO, SAC, TD3, TQC, Model

ALGORITHMS: list[Any] = [PPO, SAC, TQC, TD3, DDPG]
SMALL: dict[str, Any] = {"policy_kwargs": {"net_arch": [16]}, "batch_size": 64}


def weights(model: Model) -> np.ndarray:
    return np.concatenate([part.ravel() for layer in model.policy.layers for part in layer])


def trained(algorithm: Any, learning_rate: Any, steps: int = 768) -> Model:
    more = {"n_steps": 64} if algorithm is PPO else {"learning_starts": 64}
    return algorithm("MlpPolicy", "Pendulum-v1", learning_rate, n_envs=2, **SMALL, **more).learn(steps)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_a_schedule_sets_the_rate_of_every_step(algorithm: Any) -> None:
    number = trained(algorithm, 1e-3)
    np.testing.assert_array_equal(weights(number), weights(trained(algorithm, lambda left: 1e-3)))
    falling = trained(algorithm, lambda left: 1e-3 * left)
    assert not np.array_equal(weights(number), weights(falling))
    before = weights(falling)
    falling.learning_rate = lambda left: 0.0
    np.testing.assert_array_equal(before, weights(falling.learn(512)))


def test_a_schedule_sees_what_is_left_of_all_steps() -> None:
    seen: list[float] = []

    def rate(left: float) -> float:
        seen.append(left)
        return 1e-3

    model = trained(DDPG, rate, steps=10)
    assert seen == [1.0, 1.0, 0.8, 0.6, pytest.approx(0.4), pytest.approx(0.2)], "first when the model is made"
    seen.clear()
    model.learn(10)
    assert seen == pytest.approx([0.5, 0.4, 0.3, 0.2, 0.1])


def test_a_saved_model_begins_with_the_schedules_first_number(tmp_path: Path) -> None:
    trained(PPO, lambda left: 2e-3 * left, steps=128).save(tmp_path / "model")
    assert PPO.load(tmp_path / "model").learning_rate == pytest.approx(2e-3)


@pytest.mark.parametrize(
    ("learning_rate", "says"),
    [
        (0.0, "learning_rate is 0, expected a positive number"),
        (-1e-3, r"learning_rate is -0.001, expected a finite number"),
        ("fast", "learning_rate is 'fast', expected a number, or a function"),
        (lambda left: left - 1, "learning_rate is 0 where 1 of the training is left"),
        (lambda left: None, "learning_rate is None, expected a number"),
        (lambda left: 1.0 if left == 1 else math.nan, r"learning_rate is nan where 0.97\d* of the training is left"),
    ],
)
def test_rates_that_make_no_sense_are_said(learning_rate: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        trained(DDPG, learning_rate, steps=80)


def test_tensorboard_shows_the_course(tmp_path: Path) -> None:
    model = PPO("MultiInputPolicy", "PandaReach-v3", lambda left: 1e-3 * left, n_envs=16, tensorboard_log=tmp_path)
    model.learn(4_096).learn(1_024, tb_log_name="again")
    model.learn(1_024)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["PPO_1", "PPO_2", "again_1"]
    events = EventAccumulator(str(tmp_path / "PPO_1")).Reload()
    last = {tag: events.Scalars(tag)[-1] for tag in events.Tags()["scalars"]}
    assert {event.step for event in last.values()} == {4_096}
    assert last["train/learning_rate"].value == pytest.approx(1e-3 / 256)
    assert -50 <= last["rollout/ep_rew_mean"].value < 0 and 0 <= last["rollout/success_rate"].value <= 1
    assert last["time/fps"].value > 0 and last["train/n_updates"].value == 2 * 10 * 2048 / 64


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    model = PPO("MlpPolicy", "CartPole-v1", tensorboard_log=tmp_path / "file")
    with pytest.raises(OSError, match=r"PPO_1 cannot be written .*tensorboard_log"):
        model.learn(10)
