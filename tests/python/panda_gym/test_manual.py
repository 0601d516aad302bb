"""The examples of panda-gym's manual (version 2) and of its later pages run when only their import lines change."""

import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import manyhands as mh  # noqa: F401  registers its own environments first
from manyhands import panda_gym
from manyhands.panda_gym import registration, rendering

V2_IDS = [name.replace("-v3", "-v2") for name in panda_gym.ENV_IDS]
MANUAL = Path(__file__).parents[3] / "docs" / "panda_gym.md"


@pytest.fixture(autouse=True)
def registry() -> Iterator[None]:
    """Inside a test, gymnasium knows the drop-in's environments."""
    before = dict(gymnasium.registry)
    registration.register()
    yield
    gymnasium.registry.update(before)


@pytest.fixture
def hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulated time does not wait for the clock."""
    monkeypatch.setattr(rendering.Display, "show", lambda *_: None)


def with_our_imports(text: str) -> str:
    """The text, its import lines changed and nothing else."""
    text = re.sub(r"^import gym$", "import manyhands.panda_gym.gym as gym", text, flags=re.MULTILINE)
    text = re.sub(r"^import panda_gym$", "import manyhands.panda_gym as panda_gym", text, flags=re.MULTILINE)
    return re.sub(r"^from (gym|panda_gym\S*) import", _package, text, flags=re.MULTILINE)


def _package(match: re.Match[str]) -> str:
    name = match.group(1)
    return f"from manyhands.{'panda_gym.gym' if name == 'gym' else name} import"


def run(text: str, rounds: int = 10_000, **names: Any) -> dict[str, Any]:
    """Runs an example; loops that it leaves without an end stop after so many rounds."""
    text = with_our_imports(text)
    text = text.replace("while True:", "while next(rounds, 0):")
    text = re.sub(r"while (rew <= best_rew|not done):", r"while \1 and next(rounds, 0):", text)
    scope = {"rounds": iter([1] * rounds), **names}
    exec(text, scope)
    return scope


QUICK_START = """
import gym
import panda_gym

env = gym.make('PandaReach-v2', render=True)

obs = env.reset()
done = False
steps = 0
while not done:
    action = env.action_space.sample() # random action
    obs, reward, done, info = env.step(action)
    env.render() # wait the right amount of time to make the rendering real-time
    steps += 1
"""


def test_quick_start_takes_fifty_steps_in_real_time() -> None:
    start = time.perf_counter()
    end = run(QUICK_START)
    assert 1.9 < time.perf_counter() - start < 4.0
    assert end["steps"] == 50
    assert end["info"]["TimeLimit.truncated"] is True
    assert {value.dtype for value in end["obs"].values()} == {np.dtype(np.float64)}


MANUAL_CONTROL = """
import gym
import panda_gym

env = gym.make("PandaReach-v2", render=True)
obs = env.reset()
done = False

while not done:
    current_position = obs["observation"][0:3]
    desired_position = obs["desired_goal"][0:3]
    action = 5.0 * (desired_position - current_position)
    obs, reward, done, info = env.step(action)
    env.render()

env.close()
"""


def test_manual_control_arrives(hurry: None) -> None:
    end = run(MANUAL_CONTROL)
    assert np.linalg.norm(end["obs"]["desired_goal"] - end["obs"]["achieved_goal"]) < 0.05
    assert end["info"]["is_success"]
    assert end["info"]["is_success"].dtype == np.float64
    assert end["reward"] == 0
    end["env"].close()


SAVE_AND_RESTORE = """
import gym
import panda_gym

env = gym.make("PandaReachDense-v2", render=True)
obs = env.reset()
first = obs

while True:
    state_id = env.save_state()
    best_action = None
    rew = best_rew = env.task.compute_reward(
        obs["achieved_goal"], obs["desired_goal"], None)

    while rew <= best_rew:
        env.restore_state(state_id)
        a = env.action_space.sample()
        _, rew, _, _ = env.step(a)

    env.restore_state(state_id)
    obs, _, _, _ = env.step(a)
    env.remove_state(state_id)

env.close()
"""


def test_greedy_search_comes_nearer(hurry: None) -> None:
    # One search in eight ends farther away than it began: the manual's has no seed.
    seeded = SAVE_AND_RESTORE.replace("env.reset()", "env.reset(seed=0)\nenv.action_space.seed(0)")
    end = run(seeded, rounds=300)
    before, after = (np.linalg.norm(obs["desired_goal"] - obs["achieved_goal"]) for obs in (end["first"], end["obs"]))
    assert after < before


@pytest.mark.parametrize("name", V2_IDS)
def test_all_ids_of_version_2(name: str) -> None:
    env = panda_gym.make(name)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(env.action_space.sample())
    limit = 100 if "Stack" in name else 50
    obs = env.reset(seed=1)
    assert set(obs) == {"observation", "achieved_goal", "desired_goal"}
    dones = []
    for _ in range(limit + 5):
        obs, reward, done, info = env.step(np.zeros(env.action_space.shape))
        dones.append(done)
    assert dones == [False] * (limit - 1) + [True] * 6
    assert isinstance(reward, float)
    assert info["is_success"].shape == ()
    assert env.unwrapped.task is env.task
    assert env.reset()["observation"].dtype == np.float64
    env.close()
    env.close()


def test_looking_ahead_takes_no_steps_from_an_episode_of_version_2() -> None:
    env = panda_gym.make("PandaPush-v2", terminate_on_success=False)
    env.reset(seed=0)
    action = np.full(3, 0.1)
    dones = []
    for _ in range(50):
        state = env.save_state()
        env.step(-action)
        env.restore_state(state)
        env.remove_state(state)
        dones.append(env.step(action)[2])
    assert dones == [False] * 49 + [True]


def test_names_that_there_are_not() -> None:
    with pytest.raises(gymnasium.error.NameNotFound, match="PandaReachDense"):
        panda_gym.make("PandaJuggle-v2")
    with pytest.raises(AttributeError):
        _ = panda_gym.make("PandaReach-v2").juggle
    assert panda_gym.make("PandaReach-v3").unwrapped.sim.is_version_2 is False


MY_ROBOT_URDF = """<?xml version="1.0"?>
<robot name="my_robot">
  <link name="link0">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="link1">
    <inertial><mass value="0.5"/><inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="joint0" type="continuous">
    <parent link="link0"/>
    <child link="link1"/>
    <axis xyz="0 0 1"/>
  </joint>
</robot>
"""

MY_ROBOT = '''
import numpy as np
from gym import spaces

from panda_gym.envs.core import PyBulletRobot


class MyRobot(PyBulletRobot):
    """My robot"""

    def __init__(self, sim):
        action_dim = 1 # = number of joints; here, 1 joint, so dimension = 1
        action_space = spaces.Box(-1.0, 1.0, shape=(action_dim,), dtype=np.float32)
        super().__init__(
            sim,
            body_name="my_robot", # choose the name you want
            file_name="my_robot.urdf", # the path of the URDF file
            base_position=np.zeros(3), # the position of the base
            action_space=action_space,
            joint_indices=np.array([0]), # list of the indices, as defined in the URDF
            joint_forces=np.array([1.0]), # force applied when robot is controlled (Nm)
        )

    def set_action(self, action):
        self.control_joints(target_angles=action)

    def get_obs(self):
        return self.get_joint_angle(joint=0)

    def reset(self):
        neutral_angle = np.array([0.0])
        self.set_joint_angles(angles=neutral_angle)
'''

TEST_MY_ROBOT = """
from panda_gym.pybullet import PyBullet

sim = PyBullet(render=True)
robot = MyRobot(sim)

for _ in range(50):
    robot.set_action(np.array([1.0]))
    sim.step()
    sim.render()
"""

MY_TASK = """
import numpy as np

from panda_gym.envs.core import Task
from panda_gym.utils import distance

class MyTask(Task):
    def __init__(self, sim):
        super().__init__(sim)
        # create an cube
        self.sim.create_box(body_name="object", half_extents=np.array([1, 1, 1]), mass=1.0, position=np.array([0.0, 0.0, 0.0]))

    def reset(self):
        # randomly sample a goal position
        self.goal = np.random.uniform(-10, 10, 3)
        # reset the position of the object
        self.sim.set_base_pose("object", position=np.array([0.0, 0.0, 0.0]), orientation=np.array([1.0, 0.0, 0.0, 0.0]))

    def get_obs(self):
        # the observation is the position of the object
        observation = self.sim.get_base_position("object")
        return observation

    def get_achieved_goal(self):
        # the achieved goal is the current position of the object
        achieved_goal = self.sim.get_base_position("object")
        return achieved_goal

    def is_success(self, achieved_goal, desired_goal, info={}): # info is here for consistency
        # compute the distance between the goal position and the current object position
        d = distance(achieved_goal, desired_goal)
        # return 1.0 if the distance is < 1.0, and 0.0 otherwise
        return np.array(d < 1.0, dtype=np.float64)

    def compute_reward(self, achieved_goal, desired_goal, info={}): # info is here for consistency
        # for this example, reward = 1.0 if the task is successfull, 0.0 otherwise
        return self.is_success(achieved_goal, desired_goal, info)
"""  # noqa: E501

TEST_MY_TASK = """
from panda_gym.pybullet import PyBullet

sim = PyBullet(render=True)
task = MyTask(sim)

task.reset()
print(task.get_obs())
print(task.get_achieved_goal())
print(task.is_success(task.get_achieved_goal(), task.get_goal()))
print(task.compute_reward(task.get_achieved_goal(), task.get_goal()))
"""

MY_ENV = '''
from panda_gym.envs.core import RobotTaskEnv
from panda_gym.pybullet import PyBullet

class MyRobotTaskEnv(RobotTaskEnv):
    """My robot-task environment."""

    def __init__(self, render=False):
        sim = PyBullet(render=render)
        robot = MyRobot(sim)
        task = MyTask(sim)
        super().__init__(robot, task)
'''

TEST_MY_ENV = """
env = MyRobotTaskEnv(render=True)

obs = env.reset()
done = False
while not done:
    action = env.action_space.sample() # random action
    obs, reward, done, info = env.step(action)
    env.render() # wait a bit to give a realistic temporal rendering
"""


@pytest.fixture
def my_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "my_robot.urdf").write_text(MY_ROBOT_URDF)
    monkeypatch.chdir(tmp_path)


def test_my_robot_turns_to_one_radian(my_robot: None, hurry: None) -> None:
    end = run(MY_ROBOT + TEST_MY_ROBOT)
    assert end["robot"].get_obs() == pytest.approx(1.0, abs=1e-3)
    end["robot"].reset()
    assert end["robot"].get_obs() == 0.0


def test_my_task_prints_what_it_knows(capsys: pytest.CaptureFixture[str]) -> None:
    end = run(MY_TASK + TEST_MY_TASK)
    assert (
        capsys.readouterr().out
        == "[0. 0. 0.]\n[0. 0. 0.]\n" + 2 * f"{float(end['task'].goal @ end['task'].goal < 1)}\n"
    )
    fresh = end["MyTask"](end["PyBullet"]())
    with pytest.raises(RuntimeError, match="reset"):
        fresh.get_goal()


def test_my_environment_runs(my_robot: None, hurry: None) -> None:
    end = run(MY_ROBOT + MY_TASK + MY_ENV + TEST_MY_ENV, rounds=60)
    assert end["done"] is False
    assert end["obs"]["observation"].shape == (4,)
    assert end["obs"]["observation"].dtype == np.float64
    assert isinstance(end["reward"], float)


def test_my_environment_in_the_manner_of_version_3(my_robot: None) -> None:
    names = run(MY_ROBOT + MY_TASK)

    class MyRobotTaskEnv(panda_gym.envs.core.RobotTaskEnv):
        def __init__(self, render_mode: str = "rgb_array") -> None:
            sim = panda_gym.pybullet.PyBullet(render_mode=render_mode)
            super().__init__(names["MyRobot"](sim), names["MyTask"](sim))

    env = MyRobotTaskEnv()
    obs, info = env.reset(seed=1)
    assert set(info) == {"is_success"}
    obs, _, terminated, truncated, _ = env.step(env.action_space.sample())
    assert obs["observation"].dtype == np.float32
    assert (terminated, truncated) == (False, False)


def test_look_ahead_of_version_3() -> None:
    """The best of five sampled actions, as its pages show it."""
    env = gymnasium.make("PandaReachDense-v3").unwrapped
    env.action_space.seed(0)
    env.reset(seed=0)
    rewards = []
    for _ in range(15):
        state_id = env.save_state()
        tried = []
        for _ in range(5):
            env.restore_state(state_id)
            action = env.action_space.sample()
            tried.append((env.step(action)[1], action))
        env.restore_state(state_id)
        env.remove_state(state_id)
        reward, action = max(tried, key=lambda pair: pair[0])
        _, again, terminated, _, _ = env.step(action)
        assert again == reward
        rewards.append(again)
        if terminated:
            break
    assert rewards[-1] > 0.6 * rewards[0]
    env.close()


@pytest.mark.parametrize("block", re.findall(r"^```py\n(.*?)^```", MANUAL.read_text(), re.MULTILINE | re.DOTALL))
def test_our_own_page_runs(block: str, my_robot: None, hurry: None) -> None:
    exec(block, {"__name__": "__docs__"})
