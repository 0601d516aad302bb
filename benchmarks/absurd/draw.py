"""Random numbers as scenes want them."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
Array = NDArray[np.float64]


class Draw:
    """Numbers of one scene: the same for the same seed and number."""

    def __init__(self, seed: int, number: int) -> None:
        self.rng = np.random.default_rng((seed, number))

    def chance(self, probability: float) -> bool:
        """True so often."""
        return bool(self.rng.random() < probability)

    def pick(self, options: Sequence[T]) -> T:
        """One of them."""
        return options[int(self.rng.integers(len(options)))]

    def count(self, least: int, most: int) -> int:
        """Both ends included."""
        return int(self.rng.integers(least, most + 1))

    def uniform(self, lower: float, upper: float) -> float:
        """Between the two."""
        return float(self.rng.uniform(lower, upper))

    def log(self, lower: float, upper: float) -> float:
        """Between the two, every power of ten as often as another."""
        return float(10 ** self.rng.uniform(np.log10(lower), np.log10(upper)))

    def signed(self, lower: float, upper: float) -> float:
        """As `log`, either way."""
        return self.log(lower, upper) * self.pick((-1.0, 1.0))

    def direction(self) -> Array:
        """A unit vector (3)."""
        x = self.rng.normal(size=3)
        return x / np.linalg.norm(x)

    def within(self, radius: float) -> Array:
        """A point (3) of a ball."""
        return radius * self.rng.random() ** (1 / 3) * self.direction()

    def turn(self) -> Array:
        """A unit quaternion (4)."""
        x = self.rng.normal(size=4)
        return x / np.linalg.norm(x)
