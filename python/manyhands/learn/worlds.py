"""Whatever a user gives as an environment, as a batch to train on."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gymnasium
from gymnasium.vector import VectorEnv

from manyhands._core.envs import EnvBatch
from manyhands.arguments import whole_number
from manyhands.envs.single import ArmEnv
from manyhands.envs.vector import ArmVectorEnv
from manyhands.learn.layout import ActionLayout, ObservationLayout
from manyhands.learn.python_worlds import PythonWorlds, as_stepped, episode_limit

AnyEnv = str | gymnasium.Env[Any, Any] | VectorEnv[Any, Any, Any] | Callable[[], gymnasium.Env[Any, Any]]


@dataclass(frozen=True)
class Worlds:
    """Worlds to train on."""

    name: str
    batch: EnvBatch
    observation: ObservationLayout
    action: ActionLayout
    host: PythonWorlds | None  # that steps the batch, which does not keep it; None: they are stepped in C++

    @property
    def native(self) -> bool:
        """Whether they are stepped in C++."""
        return self.host is None

    @property
    def has_goals(self) -> bool:
        """Whether the environment has goals."""
        return self.batch.spec.goal_dim > 0


def make_worlds(env: AnyEnv, n_envs: int | None, num_threads: int | None, usual: int) -> Worlds:
    """An environment's id, an environment, a vector of them or a function that makes one. `n_envs` is how many; of what
    is one already there is one, unless it is one of this package's own, of which there are as many as wanted: `usual`
    if nothing is said.

    Raises ValueError if it cannot be trained on, and what Gymnasium raises for an unknown id.
    """
    if n_envs is not None:
        whole_number("n_envs", n_envs, 1)
    made = _made(env)
    single = made[0] if isinstance(made, list) else made
    name = checked_name(single)
    if isinstance(made, VectorEnv):
        if n_envs not in (None, made.num_envs):
            raise ValueError(f"n_envs is {n_envs}, but the vector environment has {made.num_envs} worlds")
        observation_space, action_space, count = made.single_observation_space, made.single_action_space, made.num_envs
    else:
        observation_space, action_space = single.observation_space, single.action_space
        count = n_envs
    observation, action = ObservationLayout(observation_space), ActionLayout.of(action_space)
    batch = _native_batch(single, count or usual, num_threads)
    if batch is not None:
        return Worlds(name, batch, observation, action, None)
    if isinstance(made, list):
        for _ in range((count or 1) - 1):
            made += _copies(env)
    host = PythonWorlds(as_stepped(made, observation, name), observation, action, name)
    return Worlds(name, host.batch(episode_limit(single)), observation, action, host)


def _made(env: AnyEnv) -> list[gymnasium.Env[Any, Any]] | VectorEnv[Any, Any, Any]:
    if isinstance(env, str):
        return [gymnasium.make(env)]
    if isinstance(env, gymnasium.Env):
        return [env]
    if isinstance(env, VectorEnv):
        return env
    if callable(env):
        made = env()
        if not isinstance(made, gymnasium.Env):
            raise TypeError(f"env() gave {made!r}, expected a gymnasium.Env")
        return [made]
    raise TypeError(f"env is {env!r}, expected an id, a Gymnasium environment, a vector of them or a function")


def _copies(env: AnyEnv) -> list[gymnasium.Env[Any, Any]]:
    if isinstance(env, gymnasium.Env):
        if env.spec is None:
            raise ValueError("n_envs: of this environment there is one; give its id or a function that makes one")
        return [gymnasium.make(env.spec)]
    assert not isinstance(env, VectorEnv)
    made = _made(env)
    assert isinstance(made, list)
    return made


def checked_name(env: gymnasium.Env[Any, Any] | VectorEnv[Any, Any, Any]) -> str:
    """Its id, or its class where it has none. Raises ValueError unless it has spaces."""
    name = type(env.unwrapped).__name__ if env.spec is None else env.spec.id
    for space in ("observation_space", "action_space"):
        if not isinstance(found := getattr(env, space, None), gymnasium.Space):
            raise ValueError(f"{name}.{space} is {found!r}, expected one of gymnasium.spaces")
    return name


def _native_batch(
    env: gymnasium.Env[Any, Any] | VectorEnv[Any, Any, Any], count: int, num_threads: int | None
) -> EnvBatch | None:
    """The same worlds in C++, or None if the environment is not this package's own or is wrapped."""
    inner = env.unwrapped
    if isinstance(inner, ArmVectorEnv) and inner is env:
        return inner.training_batch(num_threads)
    if not isinstance(inner, ArmEnv) or not _only_standard_wrappers(env):
        return None
    batch = inner.training_batch(count, num_threads)
    return batch if episode_limit(env) == batch.spec.max_episode_steps else None


def _only_standard_wrappers(env: Any) -> bool:
    standard = (gymnasium.wrappers.TimeLimit, gymnasium.wrappers.OrderEnforcing, gymnasium.wrappers.PassiveEnvChecker)
    while env is not env.unwrapped:
        if type(env) not in standard:
            return False
        env = env.env
    return True
