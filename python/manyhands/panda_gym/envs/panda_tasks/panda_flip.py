"""The Panda turns a cube."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.flip import Flip
from manyhands.panda_gym.pybullet import PyBullet


class PandaFlipEnv(PandaTaskEnv):
    """The Panda turns a cube."""

    block_gripper = False

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> Flip:
        return Flip(sim, reward_type=reward_type)
