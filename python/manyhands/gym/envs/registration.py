"""Environments by their ids: those registered here, and behind them Gymnasium's."""

import difflib
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

import gymnasium
from gymnasium.error import NameNotFound

from manyhands.gym import logger
from manyhands.gym.core import Env, FromGymnasium
from manyhands.gym.wrappers.time_limit import TimeLimit


@dataclass
class EnvSpec:
    """What an id stands for. entry_point: a class or function that makes the environment, or "module:name"."""

    id: str
    entry_point: Callable[..., Any] | str | None = None
    reward_threshold: float | None = None
    nondeterministic: bool = False
    max_episode_steps: int | None = None
    order_enforce: bool = True
    """Has no effect: only the step limit asks for a reset first."""
    kwargs: dict[str, Any] = field(default_factory=dict)

    def make(self, **kwargs: Any) -> Any:
        """The environment; the arguments override those that were registered."""
        entry_point = self.entry_point
        if entry_point is None:
            raise gymnasium.error.Error(f"{self.id!r} was registered without an entry_point: there is nothing to make")
        if isinstance(entry_point, str):
            module, _, name = entry_point.partition(":")
            entry_point = getattr(import_module(module), name)
        assert callable(entry_point)
        env: Any = entry_point(**{**self.kwargs, **kwargs})
        env.unwrapped.spec = self
        if isinstance(env, gymnasium.Env) and not getattr(env, "has_old_returns", False):
            env = FromGymnasium(env)
        if self.max_episode_steps is None or isinstance(env, TimeLimit):
            return env
        return TimeLimit(env, self.max_episode_steps)


class EnvRegistry(dict[str, EnvSpec]):
    """Ids and what they stand for."""

    @property
    def env_specs(self) -> "EnvRegistry":
        """Itself: its name up to version 0.23."""
        return self

    def all(self) -> list[EnvSpec]:
        """All that was registered."""
        return list(self.values())


registry = EnvRegistry()


def register(id: str, **kwargs: Any) -> None:
    """Registers an environment; the arguments are those of `EnvSpec`. One of the same id gives way, with a warning."""
    if id in registry:
        logger.warn(f"{id!r} was registered before; the new one takes its place")
    registry[id] = EnvSpec(id, **kwargs)


def spec(id: str) -> Any:
    """What an id stands for. Raises gymnasium.error.NameNotFound on one that is not known."""
    if id in registry:
        return registry[id]
    if id in gymnasium.registry:
        return gymnasium.registry[id]
    near = difflib.get_close_matches(id, [*registry, *gymnasium.registry], cutoff=0.5)
    near = list(dict.fromkeys(near))
    hint = f"did you mean {', '.join(near)}?" if near else "import the package that registers it"
    raise NameNotFound(f"there is no environment {id!r}; {hint}")


def make(id: str | EnvSpec, **kwargs: Any) -> Env:
    """An environment with the old gym's returns. "module:id" imports the module first.

    Raises gymnasium.error.NameNotFound on an id that is not known.
    """
    if isinstance(id, EnvSpec):
        return id.make(**kwargs)
    module, _, name = id.rpartition(":")
    if module:
        import_module(module)
    known = spec(name)
    return known.make(**kwargs) if isinstance(known, EnvSpec) else FromGymnasium(gymnasium.make(name, **kwargs))
