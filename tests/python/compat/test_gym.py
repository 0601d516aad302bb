"""manyhands.gym: the old gym's returns over Gymnasium."""

import copy
import pickle
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from programs import output

import manyhands  # noqa: F401  registers its environments in Gymnasium
from manyhands import gym
from manyhands.gym import spaces
from manyhands.gym.utils import seeding


class Counter(gym.Env):
    """Counts its steps."""

    action_space = spaces.Box(-2.0, 2.0, (1,), np.float32)
    observation_space = spaces.Dict({"count": spaces.Discrete(100), "push": spaces.Box(-2.0, 2.0, (1,))})

    def __init__(self, start: int = 0) -> None:
        self.start, self.count = start, start
        self.seed()

    def reset(self) -> Any:  # as version 0.21 has it
        self.count = self.start
        return self._observe(0.0)

    def step(self, action: Any) -> Any:
        self.count += 1
        return self._observe(action[0]), float(self.count), False, {"count": self.count}

    def render(self, mode: str = "human") -> Any:
        return mode

    def _observe(self, push: float) -> dict[str, Any]:
        return {"count": self.count, "push": np.array([push], np.float32)}


@pytest.fixture(autouse=True)
def counter() -> Iterator[None]:
    gym.envs.registry.pop("Counter-v0", None)
    gym.register(id="Counter-v0", entry_point=Counter, max_episode_steps=3, reward_threshold=5.0, kwargs={"start": 1})
    yield
    gym.envs.registry.pop("Counter-v0", None)


def test_environments_of_gymnasium_return_the_old_way() -> None:
    env, new = gym.make("CartPole-v1"), gymnasium.make("CartPole-v1")
    expected, _ = new.reset(seed=4)
    np.testing.assert_array_equal(env.reset(seed=4), expected)
    assert env.seed(4) == [4]
    np.testing.assert_array_equal(env.reset(), expected)
    assert env.reset(return_info=True)[1] == {}
    observation, reward, done, info = env.reset(seed=4), 0.0, False, {}
    new.reset(seed=4)
    for _ in range(600):
        observation, reward, done, info = env.step(1)
        expected, expected_reward, terminated, truncated, _ = new.step(1)
        np.testing.assert_array_equal(observation, expected)
        assert (reward, done) == (expected_reward, terminated or truncated)
        if done:
            break
    assert done and "TimeLimit.truncated" not in info
    assert env.gravity == 9.8 and isinstance(env, gym.Env) and env.unwrapped is env
    with pytest.raises(ValueError, match="render mode is 'ascii'"):
        env.render("ascii")
    with pytest.raises(AttributeError, match="no_such"):
        _ = env.no_such
    env.close()


def test_the_limit_of_a_gymnasium_environment_says_so() -> None:
    env = gym.make("Pendulum-v1")
    env.reset()
    for _ in range(199):
        assert env.step(env.action_space.sample())[2:] == (False, {})
    assert env.step(env.action_space.sample())[2:] == (True, {"TimeLimit.truncated": True})


def test_one_of_the_programs_own() -> None:
    env = gym.make("Counter-v0")
    assert env.spec.id == "Counter-v0" and env.spec.reward_threshold == 5.0
    with pytest.raises(gym.error.ResetNeeded):
        env.step([0.0])
    assert env.reset()["count"] == 1
    assert env.step([0.5])[1:] == (2.0, False, {"count": 2})
    env.step([0.5])
    assert env.step([0.5])[2:] == (True, {"count": 4, "TimeLimit.truncated": True})
    assert env.step([0.5])[2] is True
    assert env.count == 5 and env.render() == "human" and env.render("rgb_array") == "rgb_array"
    assert type(env.unwrapped) is Counter and str(env) == "<TimeLimit<Counter<Counter-v0>>>"
    assert gym.make("Counter-v0", start=7).reset()["count"] == 7
    with env as inside:
        assert inside is env
    with pytest.raises(AttributeError):
        _ = env._private


def test_registering_and_asking() -> None:
    registry = gym.envs.registration.registry
    assert "Counter-v0" in registry.env_specs and "Counter-v0" in [spec.id for spec in registry.all()]
    assert gym.spec("Counter-v0").max_episode_steps == 3 and gym.spec("CartPole-v1").id == "CartPole-v1"
    assert gym.make("manyhands.gym:Counter-v0").count == 1
    with pytest.warns(UserWarning, match="registered before"):
        gym.register(id="Counter-v0", entry_point=Counter)
    with pytest.raises(gym.error.NameNotFound, match=r"'Counter-v1'; did you mean Counter-v0"):
        gym.make("Counter-v1")
    gym.register(id="Empty-v0")
    with pytest.raises(gym.error.Error, match="entry_point"):
        gym.make("Empty-v0")
    del registry["Empty-v0"]


def test_environments_of_this_package_return_the_old_way() -> None:
    env = gym.make("PandaReach-v3", reward_type="dense")
    assert set(env.reset(seed=0)) == {"observation", "achieved_goal", "desired_goal"}
    _, reward, done, info = env.step(np.zeros(3))
    assert reward < 0 and not done and info["is_success"] == done


def test_wrappers() -> None:
    wrap = gym.wrappers
    base = gym.make("Counter-v0")
    flat = wrap.FlattenObservation(base)
    assert flat.observation_space.contains(flat.reset()) and flat.reset().shape == (101,)
    only = wrap.FilterObservation(base, ["push"])
    assert set(only.reset()) == {"push"} == set(only.observation_space.spaces)
    with pytest.raises(ValueError, match="no_such"):
        wrap.FilterObservation(base, ["no_such"])
    clip, stretch = wrap.ClipAction(base), wrap.RescaleAction(base, -1, 1)
    base.reset()
    assert clip.step(np.array([9.0]))[0]["push"] == 2.0
    assert stretch.step(np.array([0.5]))[0]["push"] == 1.0 and stretch.action_space.high == 1
    doubled = wrap.TransformReward(
        wrap.TransformObservation(base, lambda seen: seen["count"]), lambda reward: 2 * reward
    )
    assert (doubled.reset(), doubled.step([0.0])[:2]) == (1, (2, 4.0))
    counted = wrap.RecordEpisodeStatistics(base)
    counted.reset()
    infos = [counted.step([0.0])[3] for _ in range(3)]
    assert "episode" not in infos[1] and (infos[2]["episode"]["r"], infos[2]["episode"]["l"]) == (9.0, 3)
    with pytest.raises(AttributeError, match=r"wrapper 'Monitor' is not here"):
        _ = wrap.Monitor


def test_random_numbers_are_gymnasiums() -> None:
    generator, seed = seeding.np_random(7)
    expected, _ = gymnasium.utils.seeding.np_random(7)
    assert seed == 7
    np.testing.assert_array_equal(generator.uniform(-1, 1, 5), expected.uniform(-1, 1, 5))
    assert generator.rand(2, 3).shape == (2, 3) and isinstance(generator.rand(), float)
    assert generator.randn(4).shape == (4,)
    assert {int(number) for number in generator.randint(3, size=100)} == {0, 1, 2}
    assert 5 <= generator.randint(5, 8) < 8
    for again in (copy.deepcopy(generator), pickle.loads(pickle.dumps(generator))):
        assert isinstance(again, seeding.RandomNumberGenerator)
        assert copy.deepcopy(generator).random() == again.random()
    generator.seed(7)
    assert generator.random() == seeding.np_random(7)[0].random()
    assert seeding.np_random()[1] != seeding.np_random()[1]
    for wrong in (-1, 0.5, "7"):
        with pytest.raises(gym.error.Error, match="expected a whole number"):
            seeding.np_random(wrong)  # pyright: ignore[reportArgumentType]
    env = Counter()
    assert env.seed(3) == [3] and env.np_random.random() == seeding.np_random(3)[0].random()


def test_logger(capsys: pytest.CaptureFixture[str]) -> None:
    level = gymnasium.logger.min_level
    gym.logger.set_level(gym.logger.INFO)
    gym.logger.info("count %d", 3)
    gym.logger.set_level(gym.logger.ERROR)
    gym.logger.info("nothing")
    assert capsys.readouterr().out == "INFO: count 3\n"
    gym.logger.set_level(level)


def test_bullets_environments(tmp_path: Path) -> None:
    """pybullet_envs of PyBullet's wheel, on PyBullet, with our gym."""
    if not (find_spec("pybullet_envs") and find_spec("pkg_resources")):
        pytest.skip("needs PyBullet's wheel, and setuptools for it")
    text = output(
        tmp_path,
        """
        import manyhands
        manyhands.install_as("gym")
        import gym, pybullet_envs
        for name in ("CartPoleBulletEnv-v1", "MinitaurBulletEnv-v0", "HopperBulletEnv-v0", "KukaBulletEnv-v0"):
            env = gym.make(name)
            env.seed(1)
            observation = env.reset()
            assert len(env.step(env.action_space.sample())) == 4
            env.close()
            print("ran", name)
        """,
    )
    assert text.count("ran ") == 4
