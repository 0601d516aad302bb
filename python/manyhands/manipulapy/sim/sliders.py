"""Sliders and buttons of a client: on its page where it has one, else kept in software, so that programs set them."""

from typing import Any, NamedTuple

import manyhands.pybullet
from manyhands._core import pybullet_gui

p: Any = manyhands.pybullet  # its stubs take the types of defaults for those of arguments


class _Slider(NamedTuple):
    label: str
    low: float
    high: float


class Sliders:
    """Of one client. Ids are the engine's where there is a page, else numbers from 0 on."""

    def __init__(self, client: int) -> None:
        self._client = client
        self._kept: dict[int, _Slider] = {}
        self._values: dict[int, float] = {}

    def add(self, label: str, low: float, high: float, start: float) -> int:
        """A slider; with low above high a button, whose value counts clicks from `start` on."""
        number = p.addUserDebugParameter(label, low, high, start, physicsClientId=self._client)
        if number < 0:
            number = len(self._kept)
            self._values[number] = start
        self._kept[number] = _Slider(label, low, high)
        return number

    def read(self, number: int) -> float:
        if number in self._values:
            return self._values[number]
        return p.readUserDebugParameter(number, physicsClientId=self._client)

    def set(self, number: int, value: float) -> None:
        """Does what people do with a slider. Raises ValueError on a value that is not on it."""
        slider = self._kept[number]
        if slider.low <= slider.high and not slider.low <= value <= slider.high:
            raise ValueError(f"{slider.label!r} goes from {slider.low} to {slider.high}, not to {value}")
        if number in self._values:
            self._values[number] = value
        else:
            pybullet_gui.set_parameter(self._client, number, value)

    def press(self, number: int) -> None:
        """Clicks a button."""
        self.set(number, self.read(number) + 1)
