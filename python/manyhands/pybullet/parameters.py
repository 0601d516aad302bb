"""Sliders and buttons of a program's on its page."""

import math
from typing import Any

from manyhands._core import pybullet_gui
from manyhands._core.pybullet import error


class Parameters:
    """The folder in the page's panel where they are, once there are any."""

    def __init__(self, client: int, server: Any) -> None:
        """server: viser's."""
        self._client, self._gui = client, server.gui
        self._folder: Any = None
        self.handles: dict[int, Any] = {}
        """viser's, by the ids of the items."""

    def show(self, frame: pybullet_gui.ScreenFrame) -> None:
        """Adds those that are new, takes away those that are gone."""
        for gone in self.handles.keys() - {*frame.ids}:
            self.handles.pop(gone).remove()
        for number, item in frame.items:
            if item.kind == "parameter" and number not in self.handles:
                self._folder = self._folder or self._gui.add_folder("Parameters", order=0.5)
                with self._folder:
                    self.handles[number] = self._add(number, item)

    def _add(self, number: int, item: pybullet_gui.DebugItem) -> Any:
        if item.low > item.high:
            return self._add_button(number, item)
        span = item.high - item.low
        if not 0 < span < math.inf:
            return self._gui.add_text(item.text, str(item.value), disabled=True)
        step = 10.0 ** (math.floor(math.log10(span)) - 3)
        start = min(max(item.value, item.low), item.high)
        slider = self._gui.add_slider(item.text, item.low, item.high, step, start)
        slider.on_update(lambda _: self._tell(number, float(slider.value)))
        return slider

    def _add_button(self, number: int, item: pybullet_gui.DebugItem) -> Any:
        """Its value counts how often it was pressed."""
        button, count = self._gui.add_button(item.text), item.value

        def press(_: Any) -> None:
            nonlocal count
            count += 1
            self._tell(number, count)

        button.on_click(press)
        return button

    def _tell(self, number: int, value: float) -> None:
        try:
            pybullet_gui.set_parameter(self._client, number, value)
        except error:
            return  # it has just been taken away
