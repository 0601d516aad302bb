"""The Panda pushes a cube with closed fingers."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.push import Push
from manyhands.panda_gym.pybullet import PyBullet


class PandaPushEnv(PandaTaskEnv):
    """The Panda pushes a cube with closed fingers."""

    block_gripper = True

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> Push:
        return Push(sim, reward_type=reward_type)
