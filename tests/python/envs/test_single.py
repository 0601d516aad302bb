"""One environment behaves as Gymnasium's interface and panda-gym's description ask."""

import copy
import pickle
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import manyhands
from manyhands._core.envs import env_ids, make_env_batch
from manyhands.envs import ArmEnv

IDS = env_ids()


def make(name: str, **kwargs: Any) -> ArmEnv:
    env = gymnasium.make(name, **kwargs).unwrapped
    assert isinstance(env, ArmEnv)
    return env


def test_all_reach_ids_are_registered() -> None:
    gymnasium.register_envs(manyhands)
    tasks = ("Reach", "Push", "Slide", "PickAndPlace", "Stack", "Flip")
    variants = ("", "Joints", "Dense", "JointsDense")
    assert set(IDS) == {f"Panda{task}{variant}-v3" for task in tasks for variant in variants}
    assert set(IDS) <= set(gymnasium.registry)
    assert all(gymnasium.spec(name).max_episode_steps == (100 if "Stack" in name else 50) for name in IDS)


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_checks_without_a_warning(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name))
        env = gymnasium.make(name)
        env.reset(seed=0)
        env.step(env.action_space.sample())


@pytest.mark.parametrize("name", IDS)
def test_registered_limit_is_that_of_the_task(name: str) -> None:
    assert gymnasium.spec(name).max_episode_steps == make_env_batch(name, 1).spec.max_episode_steps


@pytest.mark.parametrize("name", IDS)
def test_spaces_are_those_of_panda_gym(name: str) -> None:
    env = make(name)
    grips = any(task in name for task in ("PickAndPlace", "Stack", "Flip"))
    assert env.action_space == gymnasium.spaces.Box(-1, 1, ((7 if "Joints" in name else 3) + grips,), np.float32)
    observed = {"Reach": 6, "Push": 18, "Slide": 18, "PickAndPlace": 19, "Stack": 31, "Flip": 20}
    goal = 6 if "Stack" in name else 4 if "Flip" in name else 3
    (seen,) = (size for task, size in observed.items() if task in name)
    sizes = {"observation": seen, "achieved_goal": goal, "desired_goal": goal}
    boxes = {key: gymnasium.spaces.Box(-10, 10, (size,), np.float32) for key, size in sizes.items()}
    assert env.observation_space == gymnasium.spaces.Dict(boxes)
    assert env.metadata["render_fps"] == 25


def test_the_time_limit_is_the_wrappers() -> None:
    limited, bare = gymnasium.make("PandaReach-v3"), make("PandaReach-v3")
    away = np.array([-1, -1, 1], np.float32)
    for env, expected in ((limited, [False] * 49 + [True]), (bare, [False] * 60)):
        env.reset(seed=42)
        results = [env.step(away) for _ in expected]
        assert not any(terminated for _, _, terminated, _, _ in results)
        assert [truncated for _, _, _, truncated, _ in results] == expected


def test_success_terminates_and_is_reported() -> None:
    env = make("PandaReach-v3")
    for seed in range(10):
        obs, info = env.reset(seed=seed)
        for _ in range(10):
            assert info["is_success"] is False
            obs, reward, terminated, truncated, info = env.step(5 * (obs["desired_goal"] - obs["achieved_goal"]))
            assert (reward, truncated) == (0.0 if terminated else -1.0, False)
            assert info["is_success"] is terminated
            assert terminated == (np.linalg.norm(obs["desired_goal"] - obs["achieved_goal"]) < 0.05)
            if terminated:
                break
        else:
            pytest.fail(f"seed {seed}: the goal was not reached in 10 steps")


# spec of panda-gym's seeding: the first goals of numpy's default generator
@pytest.mark.parametrize(
    ("seed", "first", "second"),
    [
        (0, (0.041089, -0.069064, 0.012292), (-0.145042, 0.093981, 0.273827)),
        (42, (0.082187, -0.018336, 0.257579), (0.059210, -0.121747, 0.292687)),
    ],
)
def test_seeds_give_the_goals_of_panda_gym(seed: int, first: tuple[float, ...], second: tuple[float, ...]) -> None:
    env = make("PandaReach-v3")
    np.testing.assert_allclose(env.reset(seed=seed)[0]["desired_goal"], first, atol=1e-6)
    np.testing.assert_allclose(env.reset()[0]["desired_goal"], second, atol=1e-6)


def test_an_environment_without_a_seed_is_different_each_time() -> None:
    goals = {tuple(make("PandaReach-v3").reset()[0]["desired_goal"]) for _ in range(5)}
    assert len(goals) == 5


def test_rewards() -> None:
    achieved = np.zeros((4, 3))
    desired = np.array([[0, 0, 0.049], [0, 0.051, 0], [0.3, 0, 0], [0, 0, 0]])
    sparse, dense = make("PandaReach-v3"), make("PandaReach-v3", reward_type="dense")
    np.testing.assert_array_equal(sparse.compute_reward(achieved, desired, {}), [0, -1, -1, 0])
    np.testing.assert_allclose(dense.compute_reward(achieved, desired), [-0.049, -0.051, -0.3, 0], atol=1e-7)
    assert sparse.compute_reward(achieved, desired).dtype == np.float32
    assert isinstance(dense.compute_reward(achieved[0], desired[0]), np.float32)
    assert dense.compute_reward(np.zeros((2, 5, 3)), np.ones((2, 5, 3))).shape == (2, 5)
    with pytest.raises(ValueError, match=r"\(4, 3\).*\(3,\)"):
        sparse.compute_reward(achieved, desired[0])


def test_step_reward_is_compute_reward() -> None:
    env = make("PandaReachJointsDense-v3")
    env.reset(seed=3)
    env.action_space.seed(3)
    for _ in range(20):
        obs, reward, *_ = env.step(env.action_space.sample())
        assert reward == env.compute_reward(obs["achieved_goal"], obs["desired_goal"], {})


def test_arguments_of_make_override_the_variant() -> None:
    env = make("PandaReach-v3", control_type="joints", reward_type="dense")
    assert env.action_space.shape == (7,)
    assert env.compute_reward(np.zeros(3), np.full(3, 0.1)) == pytest.approx(-np.sqrt(0.03))
    for argument in ("control_type", "reward_type"):
        with pytest.raises(ValueError, match=f"{argument} is 'magic', expected"):
            make("PandaReach-v3", **{argument: "magic"})
    with pytest.raises(ValueError, match="PandaReach-v3"):
        ArmEnv("PandaJuggle")


def test_a_task_is_named_with_or_without_a_version() -> None:
    np.testing.assert_equal(ArmEnv("PandaPush-v3").reset(seed=1), ArmEnv("PandaPush").reset(seed=1))
    for name in ("PandaReachJoints", "PandaReachDense-v3"):
        with pytest.raises(ValueError, match="names a variant"):
            ArmEnv(name)
    with pytest.raises(TypeError, match="the environment is 3"):
        ArmEnv(3)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (np.zeros(4), r"shape \(4,\), expected \(3,\)"),
        (np.zeros((1, 3)), r"shape \(1, 3\), expected \(3,\)"),
        (0.5, r"shape \(\), expected \(3,\)"),
        ([0, np.nan, 0], "finite"),
        ([0, np.inf, 0], "finite"),
        ([0, 1e400, 0], "finite"),
        ("up", r"no array of numbers of shape \(3,\)"),
        (["0", "1", "0"], r"no array of numbers of shape \(3,\)"),
        ([0, 1j, 0], r"no array of numbers of shape \(3,\): it holds complex128"),
        ([0, [1], 0], r"no array of numbers of shape \(3,\)"),
    ],
)
def test_bad_actions_are_refused_and_change_nothing(action: Any, message: str) -> None:
    env, other = make("PandaReach-v3"), make("PandaReach-v3")
    env.reset(seed=1)
    other.reset(seed=1)
    with pytest.raises(ValueError, match=message):
        env.step(action)
    np.testing.assert_equal(env.step(np.ones(3))[0], other.step(np.ones(3))[0])


@pytest.mark.parametrize("action", [np.array([7.0, -3.0, 1.0]), [1e300, -1e300, 1], [10**30, -(10**30), True]])
def test_actions_are_clipped(action: Any) -> None:
    env = make("PandaReach-v3")
    env.reset(seed=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        clipped = env.step(action)[0]
    env.reset(seed=1)
    np.testing.assert_equal(clipped, env.step(np.array([1.0, -1.0, 1.0]))[0])


def test_copies_and_pickles_are_environments_of_the_same_kind() -> None:
    env = make("PandaReachJointsDense-v3")
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        np.testing.assert_equal(other.reset(seed=5), env.reset(seed=5))
        np.testing.assert_equal(other.step(np.ones(7)), env.step(np.ones(7)))


@pytest.mark.parametrize(
    "twin_of", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))], ids=["copy", "pickle"]
)
def test_copies_continue_in_the_middle_of_an_episode_with_its_limit(twin_of: Callable[[Any], Any]) -> None:
    env = gymnasium.make("PandaPush-v3", terminate_on_success=False)
    env.reset(seed=3)
    env.action_space.seed(3)
    for _ in range(20):
        env.step(env.action_space.sample())
    twin = twin_of(env)
    assert twin.spec == env.spec
    assert twin.unwrapped is not env.unwrapped
    for t in range(21, 51):
        here, there = env.step(env.action_space.sample()), twin.step(twin.action_space.sample())
        np.testing.assert_equal(there, here)
        assert there[3] == (t == 50)
    np.testing.assert_equal(twin.reset(), env.reset())  # the random stream goes on


def test_looking_ahead_takes_no_steps_from_the_episode() -> None:
    env = gymnasium.make("PandaPush-v3", terminate_on_success=False)
    plain = gymnasium.make("PandaPush-v3", terminate_on_success=False)
    panda: Any = env.unwrapped
    np.testing.assert_equal(env.reset(seed=1), plain.reset(seed=1))
    for t in range(1, 51):
        state = panda.save_state()
        for _ in range(2):
            panda.step(env.action_space.sample())
        panda.restore_state(state)
        action = np.full(3, np.sin(t))
        here = env.step(action)
        np.testing.assert_equal(here, plain.step(action))
        assert here[3] == (t == 50)


def test_unknown_render_modes_are_refused_plainly() -> None:
    with pytest.raises(ValueError, match="'ansi', expected None or one of"):
        ArmEnv(render_mode="ansi")
    with pytest.raises(ValueError, match="'human', 'rgb_array', 'depth_array'"):
        make("PandaReach-v3", render_mode="foo")
    with pytest.warns(UserWarning, match="without a render mode"):
        assert ArmEnv().render() is None


@pytest.mark.parametrize("seed", [-1, 2**64])
def test_bad_seeds_are_refused(seed: int) -> None:
    with pytest.raises((ValueError, gymnasium.error.Error)):
        make("PandaReach-v3").reset(seed=seed)
