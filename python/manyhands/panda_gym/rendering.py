"""What a simulation shows: so far it keeps time, and draws nothing."""

import time
import warnings
from typing import NoReturn

MODES = ("human", "rgb_array")
RENDERERS = ("Tiny", "OpenGL")


def require_mode(mode: str, renderer: str) -> None:
    """Raises ValueError on an unknown mode, or a renderer that is unknown where one is needed."""
    if mode not in MODES:
        raise ValueError(f"render_mode is {mode!r}, expected one of {MODES}")
    if mode == "rgb_array" and renderer not in RENDERERS:
        raise ValueError(f"renderer is {renderer!r}, expected one of {RENDERERS}")


class Display:
    """Makes simulated time pass no faster than real time; says once that there is nothing to see."""

    def __init__(self) -> None:
        self._has_warned = False
        self._start: tuple[float, float] | None = None  # on the clock, in simulated time

    def show(self, simulated: float) -> None:
        """Waits until the wall clock has caught up with `simulated` [s]. Who comes late is not hurried afterwards."""
        if not self._has_warned:
            self._has_warned = True
            warnings.warn("this version opens no window: human rendering only keeps real time", UserWarning, 3)
        now = time.perf_counter()
        if self._start is None or simulated < self._start[1]:
            self._start = now, simulated
            return
        due = self._start[0] + simulated - self._start[1]
        if due > now:
            time.sleep(due - now)
        else:
            self._start = now, simulated

    def picture(self) -> NoReturn:
        """Raises NotImplementedError."""
        raise NotImplementedError("render: this version draws no pictures yet; positions are in the observation")
