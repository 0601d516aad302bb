"""manyhands.learn: a user's environment that is not as Gymnasium wants it is named, with what it returned."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

from manyhands.learn import PPO, SAC, evaluate_policy

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
    (Faulty(OBSERVATION), r"Faulty.reset\(\) returned an array of shape \(2,\) .*, expected \(observation, info\)"),
    (Faulty((OBSERVATION, None)), r"Faulty.reset\(\) returned .*, expected \(observation, info\)"),
    (
        Faulty((np.zeros(3), {})),
        rf"Faulty.reset\(\) returned an array of shape \(3,\) and dtype float64 as observation, {BOX}",
    ),
    (Faulty((np.zeros(1), {})), rf"Faulty.reset\(\) returned an array of shape \(1,\) .* as observation, {BOX}"),
    (Faulty((None, {})), rf"Faulty.reset\(\) returned None as observation, {BOX}"),
    (Faulty(({"x": np.zeros(3)}, {})), rf"returned a dict of x: an array of shape \(3,\) .* as observation, {BOX}"),
    (stepped(np.zeros((5, 2)), 0, False, False, {}), rf"step\(\) returned an array of .*5, 2.* as observation, {BOX}"),
    (stepped(OBSERVATION, 0.0, False, {}), r"Faulty.step\(\) returned 4 values, expected \(observation, reward, term"),
    (
        stepped(OBSERVATION, OBSERVATION, False, False, {}),
        r"step\(\) returned an array of shape \(2,\) .* as reward, exp",
    ),
    (
        stepped(OBSERVATION, [[0], [0, 0]], False, False, {}),
        r"step\(\) returned \[\[0\].* as reward, expected a number",
    ),
    (stepped(OBSERVATION, "1", False, False, {}), r"step\(\) returned '1' as reward, expected a number"),
    (stepped(OBSERVATION, None, False, False, {}), r"step\(\) returned None as reward, expected a number"),
    (stepped(OBSERVATION, np.nan, False, False, {}), r"Faulty.step\(\) returned a reward that is not finite"),
    (stepped(OBSERVATION, 0, OBSERVATION, False, {}), r"step\(\) returned an array .* as terminated, expected True"),
    (stepped(OBSERVATION, 0, "no", False, {}), r"step\(\) returned 'no' as terminated, expected True or False"),
    (stepped(OBSERVATION, 0, False, None, {}), r"step\(\) returned None as truncated, expected True or False"),
    (stepped(OBSERVATION, 0, 2, False, {}), r"step\(\) returned 2 as terminated, expected True or False"),
    (stepped(OBSERVATION, 0, False, False, None), r"Faulty.step\(\) returned None as info, expected a dict"),
    (Faulty(then=None), r"Faulty.step\(\) returned None, expected \(observation"),
]


@pytest.mark.parametrize(("env", "says"), BAD)
def test_what_is_returned_is_said(env: gymnasium.Env[Any, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        PPO("MlpPolicy", env, n_steps=8, **SMALL).learn(8)


@pytest.fixture(scope="module")
def model() -> PPO:
    return PPO("MlpPolicy", Faulty(), n_steps=8, **SMALL)


@pytest.mark.parametrize(("env", "says"), BAD)
def test_an_evaluation_says_the_same(model: PPO, env: gymnasium.Env[Any, Any], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        evaluate_policy(model, env)


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

    with pytest.raises(ValueError, match=r"Last.reset\(\) returned an array of shape \(7,\)"):
        PPO("MlpPolicy", SyncVectorEnv([Faulty, Faulty]), n_steps=8, **SMALL)
        PPO("MlpPolicy", Last, n_envs=3, n_steps=8, **SMALL)


@pytest.mark.parametrize(
    ("reward", "says"),
    [
        (None, r"Wants has goals and no compute_reward\(.*: write it, or set hindsight_fraction=0"),
        (-1.0, r"Wants.compute_reward\(\) returned -1.0 for goals of shape \(6, 2\), expected .* \(6,\)"),
        (np.zeros((6, 1)), r"compute_reward\(\) returned an array of shape \(6, 1\) and dtype float64 for goals"),
        ("none", r"compute_reward\(\) returned 'none' for goals of shape \(6, 2\), expected"),
    ],
)
def test_rewards_of_goals_are_said(reward: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        SAC("MultiInputPolicy", Wants(reward), learning_starts=2, **SMALL).learn(8)


def test_errors_of_compute_reward_say_what_it_was_given() -> None:
    env = Wants(None)
    env.compute_reward = lambda achieved, desired, info: info["k"]
    says = r"Wants.compute_reward\(\) raised KeyError: 'k'; .* goals of shape \(6, 2\) and an empty info"
    with pytest.raises(RuntimeError, match=says) as error:
        SAC("MultiInputPolicy", env, learning_starts=2, **SMALL).learn(8)
    assert isinstance(error.value.__cause__, KeyError)


def test_arrays_of_one_number_are_taken(model: PPO) -> None:
    env = stepped(OBSERVATION, np.full(1, 0.5), np.zeros(1, bool), np.True_, {})
    PPO("MlpPolicy", env, n_steps=8, **SMALL).learn(8)
    assert evaluate_policy(model, env) == (0.5, 0.0)


@pytest.mark.parametrize("space", ["observation_space", "action_space"])
def test_a_missing_space_is_said(space: str) -> None:
    env = Faulty()
    setattr(env, space, None)
    with pytest.raises(ValueError, match=f"Faulty.{space} is None, expected one of gymnasium.spaces"):
        PPO("MlpPolicy", env)


def test_a_function_that_makes_something_else_is_said() -> None:
    with pytest.raises(TypeError, match=r"env\(\) gave 3, expected a gymnasium.Env"):
        PPO("MlpPolicy", lambda: 3)  # pyright: ignore[reportArgumentType]
