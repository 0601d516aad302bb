"""Environments of many worlds on a page, of which it shows some."""

from typing import Any

from gymnasium.vector import VectorEnv

from manyhands import dynamics
from manyhands._core import Model
from manyhands.viewer.environments import goal_markers
from manyhands.viewer.protocols import WatchableWorlds
from manyhands.viewer.sources import Array, Marker, Neighbours, Source


class BatchSource(Source):
    """A world of many that a loop of the program's steps together, and some beside it: watched, and looked back at, but
    not moved."""

    moves = False

    def __init__(self, env: WatchableWorlds, title: str) -> None:
        super().__init__()
        self.env, self.title, self.dt = env, title, env.dt
        self.tally = env.count_episodes()
        self._model = env.bodies.model
        self._worlds = [0]
        self._steps = self._shown_step = 0
        self._seen: tuple[Array, Array] | None = None

    @property
    def model(self) -> Model:
        return self._model

    @property
    def chosen(self) -> int:
        """The world that is shown."""
        return self._worlds[0]

    def choose(self, world: int, count: int = 1) -> None:
        """Shows a world, and the next ones beside it: `count` in all."""
        self._worlds = [(world + k) % self.env.num_envs for k in range(count)]
        self._come_back()

    @property
    def q(self) -> Array:
        return self._look()[0][0]

    @property
    def time(self) -> float:
        return self._shown_step * self.dt

    def markers(self) -> list[Marker]:
        return goal_markers(self._model, self._look()[1][0])

    def neighbours(self) -> Neighbours | None:
        if len(self._worlds) == 1:
            return None
        q, goals = self._look()
        positions, quaternions = dynamics.forward_kinematics(self._model, q)
        return Neighbours(self._worlds, positions, quaternions, [goal_markers(self._model, goal) for goal in goals])

    def step(self) -> None:
        """All worlds are stepped by the loop."""

    def tick(self) -> None:
        self._steps += 1
        self._come_back()

    def reset(self) -> None:
        """Episodes begin as the loop has it; the page comes back to the present."""
        self._come_back()

    def save(self) -> Any:
        return self._worlds, self._shown_step, self._look()

    def restore(self, state: Any) -> None:
        """Shows what was, until the loop goes on from where it is."""
        self._worlds, self._shown_step, self._seen = state

    def _come_back(self) -> None:
        self._shown_step, self._seen = self._steps, None

    def _look(self) -> tuple[Array, Array]:
        if self._seen is None:
            self._seen = self.env.see(self._worlds)
        return self._seen


def source_of_worlds(env: VectorEnv[Any, Any, Any], title: str = "") -> BatchSource:
    """What shows an environment of many worlds. Raises TypeError on one of another package."""
    inner = env.unwrapped
    if not isinstance(inner, WatchableWorlds):
        raise TypeError(
            f"there is no way to show a {type(inner).__name__}: expected an environment of this package, made by "
            "gymnasium.make_vec"
        )
    return BatchSource(inner, title or (inner.spec.id if inner.spec is not None else type(inner).__name__))
