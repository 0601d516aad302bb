"""Controls of the page that both the simulation and its user move."""

import math
import time
from collections.abc import Callable
from typing import Any

_TOUCHED_FOR = 1.0  # [s] for which a control belongs to the one who moved it


class SharedSlider:
    """A slider that shows what the simulation says, and that its user may move at any time.

    The page's thread puts what its user entered into the handle, and another thread tells `entered` of it a little
    later. What is shown in between must not overwrite it.
    """

    def __init__(self, handle: Any, entered: Callable[[float], None]) -> None:
        """handle: viser's, whose value is a number; entered: called with what its user entered."""
        self.handle = handle
        self._entered = entered
        self._known = handle.value
        self._touched = -math.inf
        handle.on_update(self._on_update)

    def show(self, value: float, tolerance: float = 1e-4) -> None:
        """Moves the slider, unless its user has just done so, or it is as near as `tolerance`."""
        if self.handle.value != self._known or time.perf_counter() - self._touched < _TOUCHED_FOR:
            return
        if abs(self._known - value) > tolerance:
            self._known = value
            self.handle.value = value

    def _on_update(self, event: Any) -> None:
        if event.client_id is None:
            return
        self._touched = time.perf_counter()
        self._known = self.handle.value
        self._entered(float(self._known))
