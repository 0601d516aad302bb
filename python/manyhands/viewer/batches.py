"""Environments of many worlds on a page, of which it shows one."""

from typing import Any

from gymnasium.vector import VectorEnv

from manyhands._core import Model
from manyhands.envs.vector import PandaVectorEnv
from manyhands.viewer.environments import goal_markers
from manyhands.viewer.sources import Array, Marker, Source


class BatchSource(Source):
    """A world of many that a loop of the program's steps together: watched, and looked back at, but not moved."""

    moves = False

    def __init__(self, env: PandaVectorEnv, title: str) -> None:
        super().__init__()
        self.env, self.title, self.dt = env, title, env.dt
        self.tally = env.count_episodes()
        self._model = env.bodies.model
        self._world = 0
        self._steps = self._shown_step = 0
        self._seen: tuple[Array, Array] | None = None

    @property
    def model(self) -> Model:
        return self._model

    @property
    def chosen(self) -> int:
        """The world that is shown."""
        return self._world

    @chosen.setter
    def chosen(self, world: int) -> None:
        self._world, self._seen, self._shown_step = world, None, self._steps

    @property
    def q(self) -> Array:
        return self._look()[0]

    @property
    def time(self) -> float:
        return self._shown_step * self.dt

    def markers(self) -> list[Marker]:
        return goal_markers(self._model, self._look()[1])

    def step(self) -> None:
        """All worlds are stepped by the loop."""

    def tick(self) -> None:
        self._steps += 1
        self.chosen = self._world

    def reset(self) -> None:
        """Episodes begin as the loop has it; the page comes back to the present."""
        self.chosen = self._world

    def save(self) -> Any:
        return self._world, self._shown_step, self._look()

    def restore(self, state: Any) -> None:
        """Shows what was, until the loop goes on from where it is."""
        self._world, self._shown_step, self._seen = state

    def _look(self) -> tuple[Array, Array]:
        if self._seen is None:
            self._seen = self.env.see(self._world)
        return self._seen


def source_of_worlds(env: VectorEnv[Any, Any, Any], title: str = "") -> BatchSource:
    """What shows an environment of many worlds. Raises TypeError on one of another package."""
    inner = env.unwrapped
    if not isinstance(inner, PandaVectorEnv):
        raise TypeError(f"there is no way to show a {type(inner).__name__}: expected a PandaVectorEnv")
    return BatchSource(inner, title or (inner.spec.id if inner.spec is not None else type(inner).__name__))
