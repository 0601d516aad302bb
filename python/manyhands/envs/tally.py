"""Episodes of many worlds, counted."""

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray


class Tally:
    """How the episodes of n worlds go, and how those went that are over; arrays are (n)."""

    def __init__(self, worlds: int, mode: AutoresetMode) -> None:
        """mode: when a world whose episode is over begins the next."""
        self.mode = mode
        self.length = np.zeros(worlds, np.int64)
        """Steps of the present episodes."""
        self.total = np.zeros(worlds)
        """Sums of their rewards."""
        self.episodes = np.zeros(worlds, np.int64)
        """How many are over."""
        self.successes = np.zeros(worlds, np.int64)
        """How many of them ended with success."""
        self._over = np.zeros(worlds, np.bool_)

    def reset(self, mask: NDArray[np.bool_] | None) -> None:
        """Episodes begin in the worlds of a mask (n), or in all."""
        self._begin(np.ones_like(self._over) if mask is None else mask)

    def step(self, reward: NDArray[np.float64], ended: NDArray[np.bool_], success: NDArray[np.bool_]) -> None:
        """What a step brought (n), and whether episodes ended with it."""
        begins = self._over if self.mode == AutoresetMode.NEXT_STEP else np.zeros_like(self._over)
        self.length += 1
        self.total += reward
        self._begin(begins)
        self.episodes += ended
        self.successes += ended & success
        self._over = ended.copy()
        if self.mode == AutoresetMode.SAME_STEP:
            self._begin(ended)

    def _begin(self, worlds: NDArray[np.bool_]) -> None:
        self.length[worlds], self.total[worlds] = 0, 0.0
        self._over = self._over & ~worlds
