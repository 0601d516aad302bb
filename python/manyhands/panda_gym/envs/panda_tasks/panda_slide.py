"""The Panda slides a puck out of its reach."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.slide import Slide
from manyhands.panda_gym.pybullet import PyBullet


class PandaSlideEnv(PandaTaskEnv):
    """The Panda slides a puck out of its reach."""

    block_gripper = True

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> Slide:
        return Slide(sim, reward_type=reward_type)
