"""Gymnasium environments: `gymnasium.make("PandaReach-v3")`, `gymnasium.make_vec("PandaReach-v3", num_envs=4096)`."""

from manyhands.envs.parts import ArmSpec, Obstacle
from manyhands.envs.registration import register
from manyhands.envs.single import ArmEnv
from manyhands.envs.transfer import TRANSFER, transfer_ranges
from manyhands.envs.vector import ArmVectorEnv
from manyhands.experts import Expert

__all__ = [
    "TRANSFER",
    "ArmEnv",
    "ArmSpec",
    "ArmVectorEnv",
    "Expert",
    "Obstacle",
    "register",
    "transfer_ranges",
]
