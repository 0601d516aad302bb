"""The drop-in's environments: all ids, panda-gym's seeds and numbers, and its faults mended."""

import copy
import time
import warnings
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

import manyhands as mh
from manyhands import panda_gym
from manyhands.panda_gym import registration
from manyhands.panda_gym.envs.core import RobotTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.pybullet import PyBullet, error

TASKS = ("Reach", "Slide", "Push", "PickAndPlace", "Stack", "Flip")
WITH_OBJECTS = TASKS[1:]
KEYS = ("observation", "achieved_goal", "desired_goal")
Array = NDArray[np.float64]


@pytest.fixture(autouse=True)
def registry() -> Iterator[None]:
    """Inside a test, gymnasium knows the drop-in's environments."""
    before = dict(gymnasium.registry)
    registration.register()
    yield
    gymnasium.registry.update(before)


def make(task: str, **kwargs: Any) -> Any:
    return registration.make_env(f"Panda{task}", **kwargs)


def formula(t: int, size: int) -> Array:
    return np.sin(1.3 * t + 0.7 * np.arange(size) + 0.4)


def run(env: Any, steps: int) -> list[Any]:
    return [env.step(formula(t, env.action_space.shape[0]))[0] for t in range(steps)]


def test_the_ids_are_panda_gyms() -> None:
    assert len(panda_gym.ENV_IDS) == len(set(panda_gym.ENV_IDS)) == 24
    assert panda_gym.ENV_IDS[:5] == [
        "PandaReach-v3", "PandaReachJoints-v3", "PandaReachDense-v3", "PandaReachJointsDense-v3", "PandaSlide-v3",
    ]  # fmt: skip
    assert isinstance(panda_gym.__version__, str)


@pytest.mark.parametrize("name", panda_gym.ENV_IDS)
def test_gymnasium_checks_without_a_warning(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(name)
        check_env(env.unwrapped, skip_render_check=True)
        env.reset(seed=0)
        for _ in range(60):
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            if terminated or truncated:
                env.reset()
        env.close()
        env.close()


@pytest.mark.parametrize("name", panda_gym.ENV_IDS)
def test_stable_baselines_checks(name: str) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(gymnasium.make(name).unwrapped)


@pytest.mark.parametrize("task", TASKS)
def test_what_gymnasium_makes_has_its_parts(task: str) -> None:
    env = gymnasium.make(f"Panda{task}JointsDense-v3").unwrapped
    assert isinstance(env, RobotTaskEnv)
    assert env.sim is env.robot.sim is env.task.sim
    robot: Any = env.robot
    task_: Any = env.task
    assert (robot.control_type, task_.reward_type) == ("joints", "dense")
    assert gymnasium.spec(f"Panda{task}-v3").max_episode_steps == (100 if task == "Stack" else 50)
    assert env.metadata["render_fps"] == pytest.approx(25)
    assert "render_fps" not in RobotTaskEnv.metadata


@pytest.mark.parametrize(
    ("task", "observation", "goal", "action"),
    [("Reach", 6, 3, 3), ("Push", 18, 3, 3), ("Slide", 18, 3, 3), ("PickAndPlace", 19, 3, 4), ("Stack", 31, 6, 4),
     ("Flip", 20, 4, 4)],
)  # fmt: skip
def test_spaces_are_those_of_panda_gym(task: str, observation: int, goal: int, action: int) -> None:
    sizes = {"observation": observation, "achieved_goal": goal, "desired_goal": goal}
    boxes: dict[str, Any] = {key: gymnasium.spaces.Box(-10, 10, (size,), np.float32) for key, size in sizes.items()}
    for control_type, size in (("ee", action), ("joints", action + 4)):
        env = make(task, control_type=control_type)
        assert env.observation_space == gymnasium.spaces.Dict(boxes)
        assert env.action_space == gymnasium.spaces.Box(-1, 1, (size,), np.float32)
        obs, _ = env.reset(seed=3)
        assert {key: value.dtype for key, value in obs.items()} == dict.fromkeys(KEYS, np.dtype(np.float32))


FIRST_RESETS = {
    ("Reach", 0): ((0.041089, -0.069064, 0.012292), ()),
    ("Reach", 42): ((0.082187, -0.018336, 0.257579), ()),
    ("Push", 0): ((0.041089, -0.069064, 0.02), (-0.145042, 0.093981, 0.02)),
    ("Push", 42): ((0.082187, -0.018336, 0.02), (0.059210, -0.121747, 0.02)),
    ("Slide", 0): ((0.441088, -0.069064, 0.03), (-0.145042, 0.093981, 0.03)),
    ("Slide", 42): ((0.482187, -0.018336, 0.03), (0.059210, -0.121747, 0.03)),
    ("PickAndPlace", 0): ((0.041089, -0.069064, 0.02), (0.093981, 0.123827, 0.02)),
    ("PickAndPlace", 42): ((0.082187, -0.018336, 0.19172), (-0.121747, 0.142687, 0.02)),
    ("Stack", 0): (
        (0.041089, -0.069064, 0.02, 0.041089, -0.069064, 0.06),
        (-0.145042, 0.093981, 0.02, 0.031991, 0.068849, 0.06),
    ),
    ("Stack", 42): (
        (0.082187, -0.018336, 0.02, 0.082187, -0.018336, 0.06),
        (0.059210, -0.121747, 0.02, 0.078342, 0.085819, 0.06),
    ),
    ("Flip", 0): ((0.186517, -0.195973, 0.950047, 0.155616), (0.093981, 0.123827, 0.02)),
    ("Flip", 42): ((0.188174, -0.642228, 0.463431, 0.580833), (-0.121747, 0.142687, 0.02)),
}


@pytest.mark.parametrize(("task", "seed"), FIRST_RESETS)
def test_seeds_mean_what_they_mean_in_panda_gym(task: str, seed: int) -> None:
    goal, objects = FIRST_RESETS[task, seed]
    env = make(task)
    obs, info = env.reset(seed=seed)
    np.testing.assert_allclose(obs["desired_goal"], goal, atol=2e-6)
    names = {"Reach": [], "Stack": ["object1", "object2"]}.get(task, ["object"])
    found = [coordinate for name in names for coordinate in env.sim.get_base_position(name)]
    np.testing.assert_allclose(found, objects, atol=2e-6)
    assert info["is_success"].shape == ()


@pytest.mark.parametrize(
    ("seed", "second"), [(0, (-0.145042, 0.093981, 0.273827)), (42, (0.05921, -0.121747, 0.292687))]
)
def test_a_reset_without_a_seed_goes_on(seed: int, second: tuple[float, ...]) -> None:
    env = make("Reach")
    env.reset(seed=seed)
    np.testing.assert_allclose(env.reset()[0]["desired_goal"], second, atol=2e-6)


@pytest.mark.parametrize("task", TASKS)
def test_targets_are_shown_where_the_goal_is(task: str) -> None:
    env = make(task)
    goal = env.reset(seed=5)[0]["desired_goal"]
    if task == "Flip":
        np.testing.assert_allclose(env.sim.get_base_orientation("target"), goal, atol=1e-6)
        np.testing.assert_allclose(env.sim.get_base_position("target"), [0, 0, 0.06])
        return
    names = ["target1", "target2"] if task == "Stack" else ["target"]
    found = np.concatenate([env.sim.get_base_position(name) for name in names])
    np.testing.assert_allclose(found, goal, atol=1e-6)


@pytest.mark.parametrize("task", TASKS)
def test_save_step_reset_restore_step_gives_the_same_bits(task: str) -> None:
    env = make(task)
    env.reset(seed=11)
    run(env, 5)
    state, action = env.save_state(), env.action_space.sample()
    first = env.step(action)
    env.reset()
    run(env, 3)
    env.restore_state(state)
    again = env.step(action)
    for key in KEYS:
        assert first[0][key].tobytes() == again[0][key].tobytes()
    assert first[1:] == again[1:]
    env.remove_state(state)
    with pytest.raises(error):
        env.restore_state(state)
    with pytest.raises(KeyError):
        env.remove_state(state)


def test_a_copy_goes_its_own_way() -> None:
    env = make("Push")
    pressed_into(env, 1)
    state = env.save_state()
    twin = copy.deepcopy(env)
    assert twin.sim.world is not env.sim.world
    assert twin.robot.sim is twin.task.sim is twin.sim
    there, here = run(twin, 5)[-1], run(env, 5)[-1]
    np.testing.assert_array_equal(there["observation"], here["observation"])
    twin.sim.set_base_pose("target", np.ones(3), [0.0, 0.0, 0.0, 1.0])
    assert not np.allclose(env.sim.get_base_position("target"), 1)
    twin.restore_state(state)


@pytest.mark.parametrize(
    "make", [gymnasium.make, panda_gym.make, lambda _, **options: panda_gym.envs.PandaPushEnv(**options)]
)
def test_unknown_options_are_named_with_those_there_are(make: Any) -> None:
    with pytest.raises(TypeError, match=r"no option 'rendermode' \(it is 'human'\); there are render_mode"):
        make("PandaPush-v3", rendermode="human")
    with pytest.raises(TypeError, match=r"no option 'object_shape' .*n_substeps, time_step.*joint_forces"):
        make("PandaPush-v3", object_shape="sphere")


def test_a_saved_goal_is_a_copy() -> None:
    env = make("Reach")
    env.reset(seed=0)
    state, goal = env.save_state(), env.task.get_goal()
    env.task.goal += 1.0
    env.restore_state(state)
    np.testing.assert_array_equal(env.task.goal, goal)
    env.task.goal += 1.0
    env.restore_state(state)
    np.testing.assert_array_equal(env.task.goal, goal)


def pressed_into(env: Any, seed: int) -> tuple[list[bytes], float]:
    """What is seen of an episode in which the hand goes to the object and through it; how far it was moved."""
    obs, _ = env.reset(seed=seed)
    start = 6 if env.block_gripper else 7
    seen, place = [], slice(start, start + 2)
    before = obs["observation"][place]
    for t in range(15):
        action = np.zeros(env.action_space.shape)
        action[:3] = 10 * (obs["observation"][start : start + 3] - obs["observation"][:3] + [0, 0, 0.01 * (t % 2)])
        if not env.block_gripper:
            action[3] = 1.0 if t < 8 else -1.0
        obs = env.step(action)[0]
        seen.append(b"".join(obs[key].tobytes() for key in KEYS))
    return seen, float(np.linalg.norm(obs["observation"][place] - before))


@pytest.mark.parametrize("task", WITH_OBJECTS)
def test_episodes_do_not_depend_on_those_before(task: str) -> None:
    env = make(task)
    first = pressed_into(env, 1)
    assert first[1] > 0.001
    assert pressed_into(env, 2) != first
    assert pressed_into(env, 1) == first
    assert pressed_into(make(task), 1) == first


@pytest.mark.parametrize("reward_type", ["sparse", "dense"])
@pytest.mark.parametrize("task", TASKS)
def test_rewards_come_in_rows(task: str, reward_type: str) -> None:
    env = make(task, reward_type=reward_type)
    size = env.observation_space["desired_goal"].shape[0]
    goals = np.random.default_rng(0).normal(size=(2, 50, size)) * {"Flip": 1.0, "Stack": 0.03}.get(task, 0.02)
    if task == "Flip":
        goals /= np.linalg.norm(goals, axis=-1, keepdims=True)
        d = 1 - np.einsum("ij,ij->i", goals[0], goals[1]) ** 2
    else:
        d = np.linalg.norm(goals[0] - goals[1], axis=-1)
    limit = {"Stack": 0.1, "Flip": 0.2}.get(task, 0.05)
    rewards = env.compute_reward(goals[0], goals[1], [{}] * 50)
    assert (rewards.dtype, rewards.shape) == (np.float32, (50,))
    np.testing.assert_allclose(rewards, -d if reward_type == "dense" else -(d > limit).astype(float), atol=2e-6)
    assert 0 < np.mean(d > limit) < 1
    np.testing.assert_array_equal(env.task.is_success(goals[0], goals[1]), d < limit)
    single = env.compute_reward(goals[0, 0], goals[1, 0], None)
    assert isinstance(single, np.float32)
    assert single == rewards[0]
    with pytest.raises(AssertionError):
        env.compute_reward(goals[0, :1], goals[1], {})


def test_the_threshold_itself_is_no_success_and_no_loss() -> None:
    task = make("Reach").task
    assert task.compute_reward(np.zeros(3), np.array([0.05, 0, 0])) == 0
    assert not task.is_success(np.zeros(3), np.array([0.05, 0, 0]))
    flip = make("Flip").task
    assert flip.is_success(np.array([0, 0, 0, 1.0]), np.array([0, 0, 0, -1.0]))


def test_success_terminates_unless_told_otherwise() -> None:
    for terminates in (True, False):
        env = make("Reach", terminate_on_success=terminates)
        obs, _ = env.reset(seed=0)
        for _ in range(10):
            obs, reward, terminated, truncated, info = env.step(5 * (obs["desired_goal"] - obs["achieved_goal"]))
            if info["is_success"]:
                break
        assert info == {"is_success": True}
        assert (reward, terminated, truncated) == (0.0, terminates, False)
        assert type(reward) is float


def test_other_steps_and_thresholds() -> None:
    env = make("Push", n_substeps=5, time_step=0.004, distance_threshold=0.5)
    env.reset(seed=0)
    assert env.step(np.zeros(3))[2]
    assert env.sim.world.time == pytest.approx(0.02)
    assert env.metadata["render_fps"] == pytest.approx(50)


@pytest.mark.parametrize(
    ("kwargs", "what"),
    [({"reward_type": "shaped"}, "reward_type"), ({"control_type": "torque"}, "control_type"),
     ({"render_mode": "ansi"}, "render_mode"), ({"renderer": "Blender"}, "renderer")],
)  # fmt: skip
def test_unknown_options_are_refused(kwargs: dict[str, Any], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        make("Push", **kwargs)


@pytest.mark.parametrize("action", [[0, 0], [0, 0, 0, 0], [0, 0, np.nan], [[0, 0, 0]]])
def test_wrong_actions_are_refused(action: Any) -> None:
    env = make("Push")
    env.reset(seed=0)
    with pytest.raises(ValueError, match="action"):
        env.step(np.array(action))


def test_actions_are_clipped_and_left_alone() -> None:
    ours, clipped = make("Reach"), make("Reach")
    action = np.array([3.0, -7.0, np.inf])
    for env in (ours, clipped):
        env.reset(seed=0)
    seen = ours.step(action)[0], clipped.step(np.array([1.0, -1.0, 1.0]))[0]
    np.testing.assert_array_equal(seen[0]["observation"], seen[1]["observation"])
    np.testing.assert_array_equal(action, [3.0, -7.0, np.inf])


def test_the_panda_stands_where_it_is_put() -> None:
    sim = PyBullet()
    robot = Panda(sim, base_position=np.array([1.0, 2.0, 0.5]), joint_forces=[87, 87, 87, 87, 12, 12, 12, 20, 20])
    robot.reset()
    np.testing.assert_allclose(robot.get_ee_position(), [1.63844, 2.0, 0.69740], atol=1e-5)
    np.testing.assert_allclose(np.abs(robot.get_ee_orientation()), [0.999997, 0.0023, 0, 0], atol=1e-5)
    assert robot.joint_forces[5] == 12
    assert robot.get_obs().shape == (7,)


def test_a_robot_and_a_task_belong_together() -> None:
    task = make("Push").task
    with pytest.raises(AssertionError, match="different simulations"):
        RobotTaskEnv(Panda(PyBullet()), task)


def test_human_mode_keeps_real_time_by_itself() -> None:
    env = make("Reach", render_mode="human", render_target_position=[0, 0, 0], render_distance=1.0)
    env.reset(seed=0)
    env.step(np.zeros(3))
    before = env.sim.world.time
    start = time.perf_counter()
    for _ in range(5):
        env.step(np.zeros(3))
    assert env.sim.world.time - before == pytest.approx(0.2)
    assert time.perf_counter() - start > 0.19
    env.close()


@pytest.mark.parametrize("task", ["Reach", "PickAndPlace", "Flip"])
def test_pictures_are_those_of_the_native_environment(task: str) -> None:
    """The same camera, the same things in the same places: only the floor, which panda-gym makes a box, differs."""
    env = make(task, render_width=84, render_height=48)
    env.reset(seed=3)
    native = gymnasium.make(f"Panda{task}-v3", render_mode="rgb_array", render_width=84, render_height=48)
    native.reset(seed=3)
    ours, theirs = env.render(), native.render()
    assert ours.shape == theirs.shape == (48, 84, 3) and ours.dtype == np.uint8
    same = np.abs(ours.astype(int) - theirs.astype(int)).max(axis=2) < 12
    assert same[:, 20:60].mean() > 0.75
    bright = ours.min(axis=2) > 100
    assert same[bright].mean() > 0.9
    assert (env.sim.render(64, 32, yaw=90) != env.sim.render(64, 32)).any()


def test_many_worlds_stay_those_of_the_batch() -> None:
    envs = gymnasium.make_vec("PandaReach-v3", num_envs=2)
    assert isinstance(envs.unwrapped, mh.envs.ArmVectorEnv)
    envs.close()
