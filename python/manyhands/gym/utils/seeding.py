"""Random numbers: numpy's generator, with the names it had before too."""

from typing import Any

import numpy as np
from gymnasium.error import Error


class RandomNumberGenerator(np.random.Generator):
    """numpy's Generator, which answers to the old RandomState's names as well."""

    def rand(self, *shape: int) -> Any:
        """Uniform in [0, 1)."""
        return self.random(shape or None)

    random_sample = np.random.Generator.random

    def randn(self, *shape: int) -> Any:
        """Standard normal."""
        return self.standard_normal(shape or None)

    def randint(self, low: Any, high: Any = None, size: Any = None, dtype: Any = np.int64) -> Any:
        """Whole numbers from low to high - 1, or from 0 to low - 1."""
        return self.integers(low, high, size, dtype)

    def seed(self, seed: int | None = None) -> None:
        """Starts anew."""
        self.bit_generator.state = np_random(seed)[0].bit_generator.state

    def __reduce__(self) -> Any:
        return _restore, (self.bit_generator,)


RNG = RandomNumberGenerator


def _restore(bit_generator: np.random.BitGenerator) -> RandomNumberGenerator:
    return RandomNumberGenerator(bit_generator)


def np_random(seed: int | None = None) -> tuple[RandomNumberGenerator, int]:
    """A generator and its seed, one from the system unless given. The same seed gives Gymnasium's numbers.

    Raises gymnasium.error.Error on what is no whole number of 0 or more.
    """
    if seed is not None and not (isinstance(seed, int | np.integer) and seed >= 0):
        raise Error(f"the seed is {seed!r}; expected a whole number of 0 or more, or None")
    sequence = np.random.SeedSequence(seed if seed is None else int(seed))
    entropy: Any = sequence.entropy
    return RandomNumberGenerator(np.random.PCG64(sequence)), entropy
