"""The Panda takes a cube to a place."""

from manyhands.panda_gym.envs.panda_tasks.panda_task_env import PandaTaskEnv
from manyhands.panda_gym.envs.robots.panda import Panda
from manyhands.panda_gym.envs.tasks.pick_and_place import PickAndPlace
from manyhands.panda_gym.pybullet import PyBullet


class PandaPickAndPlaceEnv(PandaTaskEnv):
    """The Panda takes a cube to a place."""

    block_gripper = False

    def make_task(self, sim: PyBullet, robot: Panda, reward_type: str) -> PickAndPlace:
        return PickAndPlace(sim, reward_type=reward_type)
