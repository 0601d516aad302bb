"""The Panda brings its hand to a point."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.reach import Reach
from manyhands.panda_gym.pybullet import PyBullet


class PandaReachEnv(PandaTaskEnv):
    """The Panda brings its hand to a point."""

    block_gripper = True

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> Reach:
        return Reach(sim, robot.get_ee_position, reward_type=reward_type)
