"""The Panda stacks two cubes."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.stack import Stack
from manyhands.panda_gym.pybullet import PyBullet


class PandaStackEnv(PandaTaskEnv):
    """The Panda stacks two cubes."""

    block_gripper = False

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> Stack:
        return Stack(sim, reward_type=reward_type)
