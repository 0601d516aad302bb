"""The team of quadrotors as agents of their own, by PettingZoo's parallel interface."""

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from manyhands.world_envs.quadrotors import Quadrotors
from manyhands.world_envs.world_env import Row

if TYPE_CHECKING:
    ParallelEnv = object
else:
    try:
        from pettingzoo import ParallelEnv
    except ImportError:  # its methods are here without it
        ParallelEnv = object


class QuadrotorTeam(ParallelEnv):
    """`Quadrotors` whose every craft acts for itself: a `pettingzoo.ParallelEnv` where PettingZoo is installed.

    Agents are called drone0, drone1 and so on. Their spaces, rewards and ends are those of `Quadrotors`; all episodes
    end together, after 250 steps at the latest.
    """

    metadata: ClassVar[dict[str, Any]] = {"name": "quadrotor_team_v0", **Quadrotors.metadata}
    MAX_STEPS = 250

    def __init__(self, drones: int = 3, **options: Any) -> None:
        """As `Quadrotors`."""
        self._env = Quadrotors(drones, **options)
        vars(self)["metadata"] = {**self.metadata, "render_fps": self._env.metadata["render_fps"]}
        self.render_mode = self._env.render_mode
        self.possible_agents = [f"drone{k}" for k in range(drones)]
        self.agents: list[str] = []
        self.observation_spaces = {name: self._share(self._env.observation_space) for name in self.possible_agents}
        self.action_spaces = {name: self._share(self._env.action_space) for name in self.possible_agents}
        self._steps = 0

    @property
    def unwrapped(self) -> "QuadrotorTeam":
        """Itself, as PettingZoo asks."""
        return self

    def observation_space(self, agent: str) -> spaces.Box:
        """Of one agent; all are alike."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Of one agent; all are alike."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Row], dict[str, dict[str, Any]]]:
        """Starts an episode: what each observes, and its `info`."""
        seen, _ = self._env.reset(seed=seed, options=options)
        self.agents, self._steps = list(self.possible_agents), 0
        return self._split(seen), {name: {} for name in self.agents}

    def step(
        self, actions: dict[str, Row]
    ) -> tuple[dict[str, Row], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """One step of all: observations, rewards, terminations, truncations and infos by agent. Raises KeyError where
        one has no action."""
        agents = self.agents
        seen, _, terminated, truncated, info = self._env.step(np.concatenate([actions[name] for name in agents]))
        self._steps += 1
        truncated = truncated or self._steps >= self.MAX_STEPS
        if terminated or truncated:
            self.agents = []
        rewards = dict(zip(agents, info["rewards"].tolist(), strict=True))
        infos = {name: {"distance": float(way)} for name, way in zip(agents, info["distances"], strict=True)}
        return (
            self._split(seen), rewards, dict.fromkeys(agents, terminated), dict.fromkeys(agents, truncated), infos
        )  # fmt: skip

    def state(self) -> Row:
        """What all observe, one after the other."""
        return self._env.look().astype(np.float32)

    def render(self) -> NDArray[np.uint8] | None:
        """As `WorldEnv.render`."""
        return self._env.render()

    def close(self) -> None:
        """Lets go of the world."""
        self._env.close()

    def _share(self, box: spaces.Box) -> spaces.Box:
        """Of one agent, as all are alike."""
        size = len(box.low) // len(self.possible_agents)
        return spaces.Box(box.low[:size], box.high[:size])

    def _split(self, seen: Row) -> dict[str, Row]:
        rows = np.split(seen, len(self.possible_agents))
        return dict(zip(self.possible_agents, rows, strict=True))
