"""Training with the names that people know: `PPO("MlpPolicy", "CartPole-v1").learn(100_000)`.

PPO, SAC, TQC, TD3 and DDPG run in C++ on batches of worlds. Environments of this package run there too, with no Python
in the loop; any other Gymnasium environment, alone or in a vector, is stepped in Python between the same updates.
"""

from typing import TYPE_CHECKING, Any

from manyhands.learn.algorithms import DDPG, PPO, SAC, TD3, TQC
from manyhands.learn.evaluation import evaluate_policy
from manyhands.learn.model import Model
from manyhands.learn.sb3_arguments import NAMES

__all__ = ["DDPG", "PPO", "SAC", "TD3", "TQC", "Model", "evaluate_policy"]


if not TYPE_CHECKING:  # which would take every name for one that is there

    def __getattr__(name: str) -> Any:
        instead = f": {NAMES[name]}" if name in NAMES else ""
        raise AttributeError(f"{__name__} has no {name}{instead}")
