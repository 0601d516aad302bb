"""Environments on a `World`, each a short file of Python to learn from: what an environment of one's own takes.

Those of `manyhands.envs` are written in C++ and stepped by the thousand; these are scenes that a page of Python makes.
"""

from manyhands.world_envs.drawer_open import DrawerOpen
from manyhands.world_envs.kuka_reach import KukaReach
from manyhands.world_envs.parallel import QuadrotorTeam
from manyhands.world_envs.quadrotors import Quadrotors
from manyhands.world_envs.quadruped_walk import QuadrupedWalk
from manyhands.world_envs.registration import register
from manyhands.world_envs.variation import RANGES
from manyhands.world_envs.world_env import View, WorldEnv, marker

__all__ = [
    "RANGES",
    "DrawerOpen",
    "KukaReach",
    "QuadrotorTeam",
    "Quadrotors",
    "QuadrupedWalk",
    "View",
    "WorldEnv",
    "marker",
    "register",
]
