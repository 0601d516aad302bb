"""The old gym, as programs written for its versions 0.21 to 0.23 use it, over Gymnasium.

`reset` gives the observation alone, and `step` gives (observation, reward, done, info). `make` takes what was
registered here and what is registered in Gymnasium. `manyhands.install_as("gym")` makes `import gym` give this module.
"""

from gymnasium import error, spaces
from gymnasium.spaces import Space

from manyhands.gym import envs, logger, utils, wrappers
from manyhands.gym.core import ActionWrapper, Env, GoalEnv, ObservationWrapper, RewardWrapper, Wrapper
from manyhands.gym.envs import make, register, spec

__version__ = "0.23.1"  # what programs compare with: the last version of the old returns whose `reset` takes a seed

__all__ = [
    "ActionWrapper",
    "Env",
    "GoalEnv",
    "ObservationWrapper",
    "RewardWrapper",
    "Space",
    "Wrapper",
    "__version__",
    "envs",
    "error",
    "logger",
    "make",
    "register",
    "spaces",
    "spec",
    "utils",
    "wrappers",
]
