"""manyhands.learn: a user's environment that is not as Gymnasium wants it is named, with what it returned."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

from manyhands.learn import PPO, SAC

SMALL: dict[str, Any] = {"policy_kwargs": {"net_arch": [8]}, "batch_size": 8}
OBSERVATION = np.zeros(2, np.float32)


class Faulty(gymnasium.Env[Any, Any]):
    """Returns what it is told to."""

    def __init__(self, first: Any = (OBSERVATION, {}), then: Any = (OBSERVATION, 0.0, False, False, {})) -> None:
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float32)
        self.action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)
        self.first, self.then = first, then

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        return self.first

    def step(self, action: Any) -> Any:
        return self.then


class Unseeded(Faulty):
    def reset(self) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride]
        return self.first


class Wants(Faulty):
    """Its goals are rewarded as it is told."""

    def __init__(self, reward: Any) -> None:
        box = gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float32)
        keys = ("observation", "achieved_goal", "desired_goal")
        seen = dict.fromkeys(keys, OBSERVATION)
        super().__init__((seen, {}), (seen, -1.0, False, True, {}))
        self.observation_space = gymnasium.spaces.Dict(dict.fromkeys(keys, box))
        if reward is not None:
            self.compute_reward = lambda achieved, desired, info: reward


def stepped(*result: Any) -> Faulty:
    return Faulty(then=result)


BOX = r"expected one of its observation_space, Box\(-inf, inf, \(2,\), float32\)"
BAD: list[tuple[gymnasium.Env[Any, Any], str]] = [
    (Unseeded(), r"Unseeded.reset\(\) takes no seed, expected def reset\(self, \*, seed=None, options=None\)"),
    (Faulty(OBSERVATION), r"Faulty.reset\(\) returned array\(\[0., 0.\].*\), expected \(observation, info\)"),
    (Faulty((OBSERVATION, None)), r"Faulty.reset\(\) returned .*, expected \(observation, info\)"),
    (Faulty((np.zeros(3), {})), rf"Faulty.reset\(\) returned the observation array\(\[0., 0., 0.\]\), {BOX}"),
    (Faulty((np.zeros(1), {})), rf"Faulty.reset\(\) returned the observation array\(\[0.\]\), {BOX}"),
    (Faulty((None, {})), rf"Faulty.reset\(\) returned the observation None, {BOX}"),
    (Faulty(({"x": 1}, {})), rf"Faulty.reset\(\) returned the observation .'x': 1., {BOX}"),
    (stepped(np.zeros((5, 2)), 0, False, False, {}), rf"step\(\) returned the observation an array of .*5, 2.*{BOX}"),
    (stepped(OBSERVATION, 0.0, False, {}), r"Faulty.step\(\) returned 4 values, expected \(observation, reward, term"),
    (stepped(OBSERVATION, OBSERVATION, False, False, {}), r"step\(\) returned the reward array.*, expected a number"),
    (stepped(OBSERVATION, None, False, False, {}), r"step\(\) returned the reward None, expected a number"),
    (stepped(OBSERVATION, np.nan, False, False, {}), r"Faulty.step\(\) returned a reward that is not finite"),
    (stepped(OBSERVATION, 0, OBSERVATION, False, {}), r"step\(\) returned terminated as array.*, expected True or F"),
    (stepped(OBSERVATION, 0, False, False, None), r"Faulty.step\(\) returned the info None, expected a dict"),
    (Faulty(then=None), r"Faulty.step\(\) returned None, expected \(observation"),
]


@pytest.mark.parametrize(("env", "says"), BAD)
def test_what_is_returned_is_said(env: gymnasium.Env[Any, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        PPO("MlpPolicy", env, n_steps=8, **SMALL).learn(8)


def test_errors_of_the_first_reset_come_through() -> None:
    class Cold(Faulty):
        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            raise ValueError("the temperature is too low")

    with pytest.raises(ValueError, match=r"^the temperature is too low$") as error:
        PPO("MlpPolicy", Cold(), n_steps=8, **SMALL)
    assert error.traceback[-1].name == "reset"


def test_several_environments_are_checked_one_by_one() -> None:
    class Last(Faulty):
        made = 0

        def __init__(self) -> None:
            Last.made += 1
            super().__init__((np.zeros(2 if Last.made < 3 else 7), {}))

    with pytest.raises(ValueError, match=r"Last.reset\(\) returned the observation an array of shape \(7,\)"):
        PPO("MlpPolicy", SyncVectorEnv([Faulty, Faulty]), n_steps=8, **SMALL)
        PPO("MlpPolicy", Last, n_envs=3, n_steps=8, **SMALL)


@pytest.mark.parametrize(
    ("reward", "says"),
    [
        (None, r"Wants has goals and no compute_reward\(.*: write it, or set hindsight_fraction=0"),
        (-1.0, r"Wants.compute_reward\(\) returned array\(-1.\) for goals of shape \(6, 2\), expected .* \(6,\)"),
        (np.zeros((6, 1)), r"compute_reward\(\) returned an array of shape \(6, 1\) for goals"),
    ],
)
def test_rewards_of_goals_are_said(reward: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        SAC("MultiInputPolicy", Wants(reward), learning_starts=2, **SMALL).learn(8)


def test_rewards_of_one_number_are_taken() -> None:
    PPO("MlpPolicy", stepped(OBSERVATION, np.zeros(1), np.False_, 0, {}), n_steps=8, **SMALL).learn(8)


@pytest.mark.parametrize("space", ["observation_space", "action_space"])
def test_a_missing_space_is_said(space: str) -> None:
    env = Faulty()
    setattr(env, space, None)
    with pytest.raises(ValueError, match=f"Faulty.{space} is None, expected one of gymnasium.spaces"):
        PPO("MlpPolicy", env)


def test_a_function_that_makes_something_else_is_said() -> None:
    with pytest.raises(TypeError, match=r"env\(\) gave 3, expected a gymnasium.Env"):
        PPO("MlpPolicy", lambda: 3)  # pyright: ignore[reportArgumentType]
