"""Training with the names that people know: `PPO("MlpPolicy", "CartPole-v1").learn(100_000)`.

PPO, SAC, TQC, TD3 and DDPG run in C++ on batches of worlds. Environments of this package run there too, with no Python
in the loop; any other Gymnasium environment, alone or in a vector, is stepped in Python between the same updates.
"""

from manyhands.learn.algorithms import DDPG, PPO, SAC, TD3, TQC
from manyhands.learn.model import Model, evaluate_policy

__all__ = ["DDPG", "PPO", "SAC", "TD3", "TQC", "Model", "evaluate_policy"]
