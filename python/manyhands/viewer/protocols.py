"""What the viewer asks of environments. It knows them by these protocols alone."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Model

Array = NDArray[np.float64]


class Bodies(Protocol):
    """The bodies of an environment's worlds."""

    @property
    def model(self) -> Model: ...

    def configuration(self, world: int = 0) -> Array:
        """(nq), between two steps."""
        ...


@runtime_checkable
class Watchable(Protocol):
    """An environment of one world that can be looked at, and taken back to where it was."""

    @property
    def dt(self) -> float:
        """What a step takes [s]."""
        ...

    @property
    def bodies(self) -> Bodies: ...

    def observe(self) -> Mapping[str, NDArray[Any]]:
        """What is observed now, `desired_goal` among it."""
        ...

    def save_state(self) -> bytes: ...

    def restore_state(self, state: bytes) -> object: ...


class Counts(Protocol):
    """How the episodes of n worlds go; arrays are (n)."""

    length: NDArray[np.int64]
    """Steps of the present episodes."""
    total: Array
    """Sums of their rewards."""
    episodes: NDArray[np.int64]
    """How many are over."""
    successes: NDArray[np.int64]
    """How many of them ended with success."""


@runtime_checkable
class WatchableWorlds(Protocol):
    """An environment of many worlds that can be looked at."""

    num_envs: int

    @property
    def dt(self) -> float:
        """What a step takes [s]."""
        ...

    @property
    def bodies(self) -> Bodies: ...

    def see(self, worlds: Sequence[int]) -> tuple[Array, Array]:
        """Some worlds between two steps: q (n, nq), and their goals (n, goal_dim)."""
        ...

    def count_episodes(self) -> Counts:
        """What counts the episodes of all worlds from now on."""
        ...
