"""Gymnasium's wrappers around the native environments, single and vector; and what is asked for when SB3 is missing."""

import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from gymnasium.wrappers import (
    ClipAction,
    FlattenObservation,
    NormalizeReward,
    RecordEpisodeStatistics,
    RescaleAction,
    TimeAwareObservation,
    TimeLimit,
    TransformObservation,
)
from gymnasium.wrappers import vector as wrappers

import manyhands

gymnasium.register_envs(manyhands)

N = 4


def vector(name: str = "PandaReach-v3", **kwargs: Any) -> Any:
    return gymnasium.make_vec(name, num_envs=N, **kwargs)


def sync(name: str, mode: AutoresetMode) -> SyncVectorEnv:
    return SyncVectorEnv([lambda: gymnasium.make(name)] * N, autoreset_mode=mode)


def toward_goals(obs: dict[str, Any]) -> Any:
    """Toward the goal in the worlds with an even number, away from it in the others."""
    actions = np.clip(5 * (obs["desired_goal"] - obs["achieved_goal"]), -1, 1)
    actions[1::2] = [-1, -1, 1]
    return actions


def test_statistics_of_episodes() -> None:
    env = RecordEpisodeStatistics(gymnasium.make("PandaReach-v3"))
    env.reset(seed=42)
    for _ in range(50):
        *_, terminated, truncated, info = env.step(np.array([-1, -1, 1]))
    assert (terminated, truncated) == (False, True)
    assert (info["episode"]["r"], info["episode"]["l"]) == (-50, 50)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_statistics_of_vectors(mode: AutoresetMode) -> None:
    env = wrappers.RecordEpisodeStatistics(vector(autoreset_mode=mode.value))
    other = wrappers.RecordEpisodeStatistics(sync("PandaReach-v3", mode))
    obs, _ = env.reset(seed=42)
    other.reset(seed=42)
    for _ in range(120):
        actions = toward_goals(obs)
        obs, _, terminated, truncated, info = env.step(actions)
        others = other.step(actions)[-1]
        assert ("episode" in info) == (terminated | truncated).any()
        if "episode" in info:
            for key in ("r", "l"):
                np.testing.assert_array_equal(info["episode"][key], others["episode"][key])
            reached = info["final_info"]["is_success"] if mode is AutoresetMode.SAME_STEP else info["is_success"]
            np.testing.assert_array_equal(terminated, reached & info["_episode"])
    lengths, returns = list(env.length_queue), list(env.return_queue)
    assert max(lengths) == 50 > min(lengths) > 0
    assert returns == [-length + (length < 50) for length in lengths]


@pytest.mark.parametrize(("limit", "expected"), [(7, 7), (None, 50)])
def test_time_limits(limit: int | None, expected: int) -> None:
    """Of `make`, of `make_vec`, and of a wrapper around the bare environment."""
    options = {"max_episode_steps": limit} if limit else {}
    away = np.array([-1, -1, 1])
    singles = [gymnasium.make("PandaReach-v3", **options)]
    singles.append(TimeLimit(gymnasium.make("PandaReach-v3").unwrapped, expected))
    for env in singles:
        env.reset(seed=42)
        assert [env.step(away)[3] for _ in range(expected)] == [False] * (expected - 1) + [True]
    envs = vector(**options)
    envs.reset(seed=42)
    assert [bool(envs.step([away] * N)[3][0]) for _ in range(expected)] == [False] * (expected - 1) + [True]


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_infos_as_lists(mode: AutoresetMode) -> None:
    env = wrappers.DictInfoToList(wrappers.RecordEpisodeStatistics(vector(autoreset_mode=mode.value)))
    obs, infos = env.reset(seed=42)
    near = np.linalg.norm(obs["achieved_goal"] - obs["desired_goal"], axis=1) < 0.05
    assert infos == [{"is_success": one, "unstable": False} for one in near]
    ends = 0
    for _ in range(60):
        obs, _, terminated, truncated, infos = env.step(toward_goals(obs))
        for world, ended in enumerate(terminated | truncated):
            assert ("episode" in infos[world]) == ended
            if ended:
                ends += 1
                final = infos[world].get("final_info", infos[world])
                assert final["is_success"] == terminated[world]
                last = infos[world].get("final_obs", {key: rows[world] for key, rows in obs.items()})
                near = np.linalg.norm(last["achieved_goal"] - last["desired_goal"]) < 0.05
                assert near == terminated[world]
    assert ends > N


def test_flattened_observations() -> None:
    keys = ("observation", "achieved_goal", "desired_goal")
    single, bare = FlattenObservation(gymnasium.make("PandaStack-v3")), gymnasium.make("PandaStack-v3")
    flat, obs = single.reset(seed=1)[0], bare.reset(seed=1)[0]
    np.testing.assert_array_equal(flat, np.concatenate([obs[key] for key in keys]))
    assert flat in single.observation_space
    many = wrappers.FlattenObservation(vector("PandaStack-v3"))
    rows = many.reset(seed=1)[0]
    np.testing.assert_array_equal(rows[0], flat)
    assert rows in many.observation_space


def test_normalized_observations_and_rewards() -> None:
    """Flat observations: gymnasium normalizes no dictionaries."""
    env = wrappers.NormalizeObservation(wrappers.FlattenObservation(vector("PandaReachJointsDense-v3")))
    env = wrappers.NormalizeReward(env)
    env.reset(seed=0)
    env.action_space.seed(0)
    steps = [env.step(env.action_space.sample()) for _ in range(300)]
    seen, rewards = (np.concatenate([step[k] for step in steps]) for k in (0, 1))
    assert seen.shape == (300 * N, 12)
    np.testing.assert_allclose(seen.mean(axis=0), 0, atol=0.5)
    np.testing.assert_allclose(seen.std(axis=0), 1, atol=0.5)
    assert -10 < rewards.min() < rewards.max() <= 0


def test_changed_observations_and_actions() -> None:
    """A chain of vector wrappers does what the single ones do in a SyncVectorEnv; gymnasium has them for NEXT_STEP."""
    change: dict[str, Any] = {
        "func": lambda obs: obs["desired_goal"] - obs["achieved_goal"],
        "observation_space": gymnasium.spaces.Box(-1, 1, (3,), np.float32),
    }
    bounds = np.float32(-2), np.float32(2)

    def single() -> gymnasium.Env[Any, Any]:
        env = TransformObservation(gymnasium.make("PandaReach-v3"), **change)
        return ClipAction(RescaleAction(env, *bounds))

    changed = wrappers.VectorizeTransformObservation(vector(), TransformObservation, **change)
    ours, theirs = wrappers.ClipAction(wrappers.RescaleAction(changed, *bounds)), SyncVectorEnv([single] * N)
    np.testing.assert_array_equal(ours.reset(seed=3)[0], theirs.reset(seed=3)[0])
    rng = np.random.default_rng(3)
    for _ in range(60):
        actions = rng.uniform(-3, 3, (N, 3)).astype(np.float32)
        np.testing.assert_equal(ours.step(actions), theirs.step(actions))


def test_time_in_observations() -> None:
    env = TimeAwareObservation(gymnasium.make("PandaReach-v3"), flatten=False)
    env.reset(seed=42)
    times = [env.step(np.array([-1, -1, 1]))[0]["time"][0] for _ in range(50)]
    assert times == list(range(1, 51))


def test_normalized_rewards_of_one_world() -> None:
    env = NormalizeReward(gymnasium.make("PandaReachDense-v3"), gamma=0.9)
    env.reset(seed=42)
    rewards = [env.step(np.array([-1, -1, 1]))[1] for _ in range(50)]
    assert all(np.isfinite(rewards))
    assert max(rewards) < 0


def test_stable_baselines_is_asked_for_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "manyhands.envs.sb3", raising=False)
    for name in [name for name in sys.modules if name.startswith("stable_baselines3.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    with pytest.raises(ImportError, match="pip install stable-baselines3"):
        import manyhands.envs.sb3  # noqa: F401
