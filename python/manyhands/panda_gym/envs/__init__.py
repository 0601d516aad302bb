"""Robots, tasks and environments."""

from manyhands.panda_gym.envs.panda_tasks import (
    PandaFlipEnv,
    PandaPickAndPlaceEnv,
    PandaPushEnv,
    PandaReachEnv,
    PandaSlideEnv,
    PandaStackEnv,
)

__all__ = ["PandaFlipEnv", "PandaPickAndPlaceEnv", "PandaPushEnv", "PandaReachEnv", "PandaSlideEnv", "PandaStackEnv"]
