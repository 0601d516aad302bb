"""rl_zoo3.train on the native batch: the same arguments, all worlds stepped together.

python examples/rl_zoo/train.py --algo sac --env PandaPush-v3 -conf examples/rl_zoo/sac.yml
"""

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
from rl_zoo3.exp_manager import ExperimentManager  # pyright: ignore[reportMissingImports]
from rl_zoo3.train import train  # pyright: ignore[reportMissingImports]
from stable_baselines3.common.vec_env import VecMonitor  # pyright: ignore[reportMissingImports]

import manyhands
from manyhands.envs.sb3 import SB3VecEnv


def native(env_fns: Sequence[Callable[[], Any]]) -> VecMonitor:
    """In the place of DummyVecEnv: one environment is made to learn its id, its options and where it logs."""
    first = env_fns[0]()
    spec, log = first.spec, first.results_writer
    first.close()
    options = {name: value for name, value in spec.kwargs.items() if name not in gymnasium.spec(spec.id).kwargs}
    envs = SB3VecEnv(spec.id, len(env_fns), max_episode_steps=spec.max_episode_steps, **options)
    return VecMonitor(envs, filename=log.file_handler.name if log else None)


if __name__ == "__main__":
    gymnasium.register_envs(manyhands)
    ExperimentManager.default_vec_env_cls = staticmethod(native)
    train()
