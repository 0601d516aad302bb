"""The last minutes of a simulation, to go back to."""

from bisect import bisect_right
from collections import deque
from typing import Any


class History:
    """States in the order of their times [s]; the oldest are forgotten."""

    def __init__(self, length: int) -> None:
        """length: how many states are kept."""
        self._states: deque[tuple[float, Any]] = deque(maxlen=length)

    def __len__(self) -> int:
        return len(self._states)

    @property
    def span(self) -> tuple[float, float]:
        """The times of the first and the last state; (0, 0) without any."""
        return (self._states[0][0], self._states[-1][0]) if self._states else (0.0, 0.0)

    def clear(self) -> None:
        self._states.clear()

    def add(self, time: float, state: Any) -> None:
        """Remembers a state, and forgets those that were to come after it in another run of events."""
        while self._states and self._states[-1][0] >= time:
            self._states.pop()
        self._states.append((time, state))

    def at(self, time: float) -> tuple[float, Any] | None:
        """The last state that is not after `time`, or the first of all, and its time; None without any."""
        if not self._states:
            return None
        return self._states[max(0, bisect_right(self._states, time, key=lambda entry: entry[0]) - 1)]
