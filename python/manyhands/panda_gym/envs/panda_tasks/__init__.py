"""The six environments."""

from manyhands.panda_gym.envs.panda_tasks.panda_flip import PandaFlipEnv
from manyhands.panda_gym.envs.panda_tasks.panda_pick_and_place import PandaPickAndPlaceEnv
from manyhands.panda_gym.envs.panda_tasks.panda_push import PandaPushEnv
from manyhands.panda_gym.envs.panda_tasks.panda_reach import PandaReachEnv
from manyhands.panda_gym.envs.panda_tasks.panda_slide import PandaSlideEnv
from manyhands.panda_gym.envs.panda_tasks.panda_stack import PandaStackEnv

__all__ = ["PandaFlipEnv", "PandaPickAndPlaceEnv", "PandaPushEnv", "PandaReachEnv", "PandaSlideEnv", "PandaStackEnv"]
