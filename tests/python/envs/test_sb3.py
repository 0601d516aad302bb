"""Stable-Baselines3 on the native batch: what its own vector of single environments gives, and hindsight replay."""

import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3: pip install stable-baselines3")

from stable_baselines3 import DDPG, SAC, HerReplayBuffer
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor, VecNormalize

from manyhands._core.envs import env_ids
from manyhands.envs.sb3 import SB3VecEnv, make_sb3

N = 6


def actions_for(obs: dict[str, Any], size: int, rng: np.random.Generator) -> Any:
    """At random, in half of the worlds toward the goal so that Reach succeeds early there."""
    actions = rng.uniform(-1, 1, (N, size)).astype(np.float32)
    if size == 3:
        actions[::2] = np.clip(5 * (obs["desired_goal"] - obs["achieved_goal"])[::2], -1, 1)
    return actions


@pytest.mark.parametrize("name", ["PandaReach-v3", "PandaPushJointsDense-v3", "PandaStack-v3"])
def test_equals_dummy_vec_env(name: str) -> None:
    ours, theirs = SB3VecEnv(name, N, num_threads=2), DummyVecEnv([lambda: gymnasium.make(name)] * N)
    assert (ours.observation_space, ours.action_space) == (theirs.observation_space, theirs.action_space)
    assert ours.seed(7) == theirs.seed(7)
    obs = ours.reset()
    np.testing.assert_equal(obs, dict(theirs.reset()))
    assert ours.reset_infos == theirs.reset_infos
    (size,), rng = ours.action_space.shape, np.random.default_rng(7)
    limit = gymnasium.spec(name).max_episode_steps
    ends = {True: 0, False: 0}  # timed out or not
    for _ in range(limit + 10):
        actions = actions_for(obs, size, rng)
        obs, reward, done, infos = ours.step(actions)
        other_obs, other_reward, other_done, other_infos = theirs.step(actions)
        np.testing.assert_equal((obs, reward, done, infos), (dict(other_obs), other_reward, other_done, other_infos))
        assert (reward.dtype, done.dtype) == (other_reward.dtype, other_done.dtype)
        assert ours.reset_infos == theirs.reset_infos
        for info in infos:
            assert ("terminal_observation" in info) == (info["TimeLimit.truncated"] or info["is_success"])
            if "terminal_observation" in info:
                ends[info["TimeLimit.truncated"]] += 1
    assert ends[True] > 0
    assert ends[False] > 0 or "Reach" not in name
    np.testing.assert_equal(ours.reset(), dict(theirs.reset()))  # the seeds were for one reset


def test_what_is_observed_last_is_not_of_the_next_episode() -> None:
    env = SB3VecEnv("PandaReach-v3", N, max_episode_steps=3)
    env.seed(0)
    before = env.reset()
    for _ in range(3):
        after, _, done, infos = env.step(np.zeros((N, 3)))
    assert done.all()
    for i, info in enumerate(infos):
        np.testing.assert_array_equal(info["terminal_observation"]["desired_goal"], before["desired_goal"][i])
        assert not np.array_equal(after["desired_goal"][i], before["desired_goal"][i])


def test_attributes_and_methods_of_the_worlds() -> None:
    env = SB3VecEnv("PandaPushDense-v3", N)
    goals = np.random.default_rng(0).uniform(-1, 1, (2, 50, 3)).astype(np.float32)
    (reward,) = env.env_method("compute_reward", *goals, [{}] * 50, indices=[0])
    np.testing.assert_allclose(reward, -np.linalg.norm(goals[0] - goals[1], axis=1), rtol=1e-6)
    assert len(env.env_method("compute_reward", *goals)) == N
    assert env.get_attr("action_space", indices=2) == [env.action_space]
    assert env.get_attr("observation_space", indices=[0, 3]) == [env.observation_space] * 2
    assert env.has_attr("compute_reward")
    assert not env.has_attr("juggle")
    env.set_attr("colour", "red")
    assert env.get_attr("colour") == ["red"] * N
    with pytest.raises(ValueError, match="share 'colour'"):
        env.set_attr("colour", "blue", indices=[0])
    assert env.env_is_wrapped(Monitor, indices=[0, 1]) == [False, False]
    for method in ("reset", "step"):
        with pytest.raises(ValueError, match=f"call {method} of"):
            env.env_method(method)
    env.close()


def test_options_are_checked() -> None:
    with pytest.raises(ValueError, match="PandaJuggle"):
        make_sb3("PandaJuggle-v3")
    with pytest.raises(ValueError, match="num_envs"):
        make_sb3("PandaReach-v3", num_envs=0)
    with pytest.raises(TypeError, match="copy"):
        make_sb3("PandaReach-v3", copy=False)
    env = SB3VecEnv("PandaReach-v3", 2)
    env.reset()
    with pytest.raises(ValueError, match=r"expected \(2, 3\)"):
        env.step(np.zeros((3, 2)))


def test_seeds_of_make() -> None:
    def goals(seed: int | None) -> Any:
        return make_sb3("PandaReach-v3", num_envs=3, seed=seed).reset()["desired_goal"]

    np.testing.assert_array_equal(goals(5)[1:], goals(6)[:-1])
    assert not np.array_equal(goals(None), goals(None))


@pytest.mark.parametrize("algorithm", [SAC, DDPG])
def test_hindsight_replay(algorithm: Any) -> None:
    env = make_sb3("PandaReach-v3", num_envs=8, seed=0, num_threads=1)
    model = algorithm(
        "MultiInputPolicy",
        env,
        replay_buffer_class=HerReplayBuffer,
        replay_buffer_kwargs={"n_sampled_goal": 4},
        policy_kwargs={"net_arch": [16]},
        learning_starts=416,  # more than an episode in each world
        batch_size=32,
        device="cpu",
        seed=0,
    )
    model.learn(560)
    assert model.num_timesteps == 560
    assert model._n_updates > 0
    assert len(model.ep_info_buffer) == len(model.ep_success_buffer) >= 8

    batch = model.replay_buffer.sample(200)
    achieved, desired = (batch.next_observations[key].numpy() for key in ("achieved_goal", "desired_goal"))
    distance = np.linalg.norm(achieved - desired, axis=1)
    np.testing.assert_array_equal(batch.rewards.numpy()[:, 0], np.where(distance < 0.05, 0.0, -1.0))
    assert 0 < np.count_nonzero(distance < 0.05) < 200


def test_success_rates() -> None:
    class Toward:
        """A policy that moves the hand to the goal in the worlds with an even number, away from it in the others."""

        def predict(self, obs: Any, **_: Any) -> tuple[Any, None]:
            actions = np.clip(10 * (obs["desired_goal"] - obs["achieved_goal"]), -1, 1)
            actions[1::2] = [-1, -1, 1]
            return actions, None

    successes: list[bool] = []

    def note(names: dict[str, Any], _: dict[str, Any]) -> None:
        if names["done"]:
            successes.append(names["info"]["is_success"])

    env = make_sb3("PandaReach-v3", num_envs=4, seed=42)
    assert isinstance(env, VecMonitor)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        returns, lengths = evaluate_policy(
            Toward(), env, n_eval_episodes=20, callback=note, return_episode_rewards=True
        )
    assert np.mean(successes) == 0.5
    assert [length == 50 for length in lengths] == [not success for success in successes]
    for success, total, length in zip(successes, returns, lengths, strict=True):
        assert total == -length + success  # the last step of a success costs nothing


def test_normalized_observations() -> None:
    bare = make_sb3("PandaPush-v3", num_envs=16, seed=0, max_episode_steps=4, terminate_on_success=False)
    env = VecNormalize(bare, norm_reward=False)
    env.reset()
    for _ in range(20):
        *_, done, infos = env.step(np.random.default_rng(0).uniform(-1, 1, (16, 3)))
    assert done.all()
    ends = [env.unnormalize_obs(info["terminal_observation"]) for info in infos]
    heights = [end["observation"][2] for end in ends]
    assert 0 < min(heights) < max(heights) < 0.5  # of the hands, which start 20 cm above the table


@pytest.mark.parametrize("name", env_ids())
def test_single_environments_pass_the_check_without_a_warning(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(name).unwrapped)  # it looks for compute_reward through no wrapper


ZOO = Path(__file__).parents[3] / "examples/rl_zoo"


@pytest.mark.parametrize("algorithm", ["sac", "tqc", "ddpg"])
def test_rl_zoo_trains_from_our_files(algorithm: str, tmp_path: Path) -> None:
    """Its own manager reads the file, and a model learns from it; every id has its entry."""
    yaml = pytest.importorskip("yaml")
    manager = pytest.importorskip("rl_zoo3.exp_manager", reason="needs RL Zoo: pip install rl_zoo3")
    file = ZOO / f"{algorithm}.yml"
    assert set(yaml.safe_load(file.read_text())) == {"defaults", *env_ids()}
    experiment = manager.ExperimentManager(
        SimpleNamespace(),
        algorithm,
        "PandaReach-v3",
        str(tmp_path),
        n_timesteps=1616,
        eval_freq=-1,
        seed=0,
        device="cpu",
        hyperparams={"buffer_size": 10_000},
        config=str(file),
        verbose=0,
    )
    model, _ = experiment.setup_experiment()
    model.learn(1616)
    assert model._n_updates == 8
    assert isinstance(model.replay_buffer, HerReplayBuffer)
