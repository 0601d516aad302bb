"""A drop-in for the package panda-gym: `import manyhands.panda_gym as panda_gym`, and the rest stays as it was.

Importing it makes `gymnasium.make("PandaReach-v3")` and its 23 kin give environments with `sim`, `robot` and `task`,
one world in double precision each. `gymnasium.make_vec` goes on giving the many worlds of `manyhands.envs`. Ids in -v2
come from `manyhands.panda_gym.gym`, a stand-in for the old gym. docs/panda_gym.md lists what is the same and what was
mended.
"""

from importlib.metadata import PackageNotFoundError, version

from manyhands.panda_gym import assets, envs, gym, pybullet, registration, utils
from manyhands.panda_gym.gym import make

ENV_IDS = registration.register()

try:
    __version__ = version("manyhands")
except PackageNotFoundError:  # run from a source tree
    __version__ = "0"

__all__ = ["ENV_IDS", "__version__", "assets", "envs", "gym", "make", "pybullet", "utils"]
