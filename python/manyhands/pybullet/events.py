"""Keys and clicks on a page, as a program's events.

Pages tell of keys that are pressed, and again while they are held, but not of keys that are let go: a key is let go
when it has not been told of for a moment. Of the mouse they tell clicks in the scene.
"""

import time
from typing import Any

from manyhands._core import pybullet as p
from manyhands._core import pybullet_gui
from manyhands._core.pybullet import error

_HELD_FOR = 0.15  # [s]: longer than a keyboard takes to repeat a key

_SPECIAL = {
    "space": p.B3G_SPACE, "enter": p.B3G_RETURN, "backspace": p.B3G_BACKSPACE, "delete": p.B3G_DELETE,
    "insert": p.B3G_INSERT, "home": p.B3G_HOME, "end": p.B3G_END, "pageup": p.B3G_PAGE_UP,
    "pagedown": p.B3G_PAGE_DOWN, "arrowup": p.B3G_UP_ARROW, "arrowdown": p.B3G_DOWN_ARROW,
    "arrowleft": p.B3G_LEFT_ARROW, "arrowright": p.B3G_RIGHT_ARROW, "escape": 27, "tab": 9,
}  # fmt: skip
KEYS = {letter: ord(letter.lower()) for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"} | _SPECIAL
"""PyBullet's codes of the keys that pages tell of."""


class Keys:
    """Listens once a program has asked for keys."""

    def __init__(self, client: int, server: Any) -> None:
        self._client, self._gui = client, server.gui
        self._listens = False
        self._until: dict[int, float] = {}  # codes, and when they are let go

    def pass_on(self) -> None:
        """With each frame: lets go of keys."""
        if not self._listens:
            self._listens = True
            for key, code in KEYS.items():
                command = self._gui.add_command(f"Key {key}", hotkey=key)
                command.on_trigger(lambda _, code=code: self.press(code))
        now = time.perf_counter()
        for code in [code for code, until in self._until.items() if until < now]:
            self._until.pop(code, None)
            self._tell(code, down=False)

    def press(self, code: int) -> None:
        """A key is pressed, or still held."""
        self._until[code] = time.perf_counter() + _HELD_FOR
        self._tell(code, down=True)

    def _tell(self, code: int, *, down: bool) -> None:
        try:
            pybullet_gui.press_key(self._client, code, down)
        except error:
            return  # the client has just been disconnected


class Mouse:
    """Listens once a program has asked for the mouse."""

    def __init__(self, client: int, server: Any) -> None:
        self._client, self._scene = client, server.scene
        self._listens = False

    def pass_on(self) -> None:
        """With each frame."""
        if not self._listens:
            self._listens = True
            self._scene.on_click()(self._click)

    def _click(self, event: Any) -> None:
        camera = event.client.camera
        self.click(event.screen_pos[0] * camera.image_width, event.screen_pos[1] * camera.image_height)

    def click(self, x: float, y: float) -> None:
        """The left button was pressed and let go at a pixel."""
        try:
            for is_down in (True, False):
                pybullet_gui.click_mouse(self._client, 0, is_down, x, y)
        except error:
            return  # the client has just been disconnected
