"""Environments and wrappers in the manner of the old gym."""

from typing import Any

import gymnasium

from manyhands.gym.utils import seeding


class Env:
    """An environment. Those of one's own define `action_space`, `observation_space`, `reset` and `step`."""

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  as the old gym has it
    reward_range = (-float("inf"), float("inf"))
    spec: Any = None
    action_space: Any = None
    observation_space: Any = None
    _np_random: seeding.RandomNumberGenerator | None = None

    @property
    def np_random(self) -> seeding.RandomNumberGenerator:
        """The source of random numbers; seeded from the system until `seed` or `reset` seeds it."""
        if self._np_random is None:
            self._np_random, _ = seeding.np_random()
        return self._np_random

    @np_random.setter
    def np_random(self, generator: seeding.RandomNumberGenerator) -> None:
        self._np_random = generator

    @property
    def unwrapped(self) -> Any:
        """The environment without wrappers."""
        return self

    def reset(self, *, seed: int | None = None, return_info: bool = False, options: Any = None) -> Any:
        """Starts an episode and gives its first observation. Here it seeds `np_random`, if a seed is given."""
        if seed is not None:
            self._np_random, _ = seeding.np_random(seed)

    def step(self, action: Any) -> Any:
        """(observation, reward, done, info)."""
        raise NotImplementedError(f"{type(self).__name__} has no step")

    def render(self, mode: str = "human") -> Any:
        """Shows the environment, or gives a picture with mode "rgb_array"."""
        raise NotImplementedError(f"{type(self).__name__} has no render")

    def seed(self, seed: int | None = None) -> list[int]:
        """Seeds `np_random`; gives the seed."""
        self._np_random, seed = seeding.np_random(seed)
        return [seed]

    def close(self) -> None:
        """Frees what the environment holds."""

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __str__(self) -> str:
        return f"<{type(self).__name__}{f'<{self.spec.id}>' if self.spec else ''}>"


class GoalEnv(Env):
    """An environment whose observation is a dict of `observation`, `achieved_goal` and `desired_goal`."""

    def compute_reward(self, achieved_goal: Any, desired_goal: Any, info: Any) -> Any:
        """The reward of having achieved one goal where another was wanted."""
        raise NotImplementedError(f"{type(self).__name__} has no compute_reward")


class Wrapper(Env):
    """An environment around another; what it does not have itself, it asks the other for."""

    def __init__(self, env: Any) -> None:
        self.env = env
        for name in ("action_space", "observation_space", "metadata", "reward_range", "spec"):
            if hasattr(env, name):
                setattr(self, name, getattr(env, name))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "env":  # the second while it is being copied
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return getattr(self.env, name)

    @property
    def unwrapped(self) -> Any:
        """The environment without wrappers."""
        return self.env.unwrapped

    @property
    def np_random(self) -> Any:
        """That of the environment."""
        return self.env.np_random

    @np_random.setter
    def np_random(self, generator: Any) -> None:
        self.env.np_random = generator

    def reset(self, **kwargs: Any) -> Any:
        """As the environment's."""
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> Any:
        """As the environment's."""
        return self.env.step(action)

    def render(self, mode: str = "human", **kwargs: Any) -> Any:
        """As the environment's."""
        return self.env.render(mode, **kwargs)

    def seed(self, seed: int | None = None) -> Any:
        """As the environment's."""
        return self.env.seed(seed)

    def close(self) -> None:
        """As the environment's."""
        self.env.close()

    def __str__(self) -> str:
        return f"<{type(self).__name__}{self.env}>"

    __repr__ = __str__


class ObservationWrapper(Wrapper):
    """Changes observations by its `observation`."""

    def observation(self, observation: Any) -> Any:
        """What is seen instead."""
        raise NotImplementedError(f"{type(self).__name__} has no observation")

    def reset(self, **kwargs: Any) -> Any:
        if kwargs.get("return_info"):
            observation, info = self.env.reset(**kwargs)
            return self.observation(observation), info
        return self.observation(self.env.reset(**kwargs))

    def step(self, action: Any) -> Any:
        observation, *rest = self.env.step(action)
        return self.observation(observation), *rest


class RewardWrapper(Wrapper):
    """Changes rewards by its `reward`."""

    def reward(self, reward: Any) -> Any:
        """What is earned instead."""
        raise NotImplementedError(f"{type(self).__name__} has no reward")

    def step(self, action: Any) -> Any:
        observation, reward, *rest = self.env.step(action)
        return observation, self.reward(reward), *rest


class ActionWrapper(Wrapper):
    """Changes actions by its `action`."""

    def action(self, action: Any) -> Any:
        """What is done instead."""
        raise NotImplementedError(f"{type(self).__name__} has no action")

    def step(self, action: Any) -> Any:
        return self.env.step(self.action(action))


class FromGymnasium(Env):
    """An environment of Gymnasium with the old gym's returns; what else is asked of it, the environment answers."""

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        self.env = env
        self.action_space, self.observation_space = env.action_space, env.observation_space
        self.metadata, self.spec = env.metadata, env.spec
        self._seed: int | None = None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name == "env":
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return getattr(self.env.unwrapped, name)

    @property
    def np_random(self) -> Any:
        """That of the environment."""
        return self.env.unwrapped.np_random

    @np_random.setter
    def np_random(self, generator: Any) -> None:
        self.env.unwrapped.np_random = generator

    def reset(self, *, seed: int | None = None, return_info: bool = False, options: Any = None) -> Any:
        """The first observation of an episode; with `return_info` (observation, info)."""
        seed, self._seed = self._seed if seed is None else seed, None
        observation, info = self.env.reset(seed=seed, options=options)
        return (observation, info) if return_info else observation

    def step(self, action: Any) -> tuple[Any, Any, bool, dict[str, Any]]:
        """(observation, reward, done, info); `info["TimeLimit.truncated"]` where only the limit ended the episode."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        if truncated:
            info["TimeLimit.truncated"] = not terminated
        return observation, reward, bool(terminated or truncated), info

    def render(self, mode: str = "human") -> Any:
        """Shows the environment, or gives a picture. Raises ValueError on a mode that the environment does not have."""
        inner: Any = self.env.unwrapped
        if inner.render_mode != mode:
            modes = self.metadata.get("render_modes", [])
            if mode not in modes:
                raise ValueError(f"render mode is {mode!r}; {self} has {modes}")
            inner.render_mode = mode
        return self.env.render()

    def seed(self, seed: int | None = None) -> list[int]:
        """Seeds the next `reset`; gives the seed."""
        self._seed = seeding.np_random(seed)[1]
        return [self._seed]

    def close(self) -> None:
        """Frees what the environment holds."""
        self.env.close()
