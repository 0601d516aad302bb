"""The page of one client with a window: its bodies, and what the program draws and asks for besides."""

import secrets
from typing import Any

import numpy as np

from manyhands._core import pybullet_gui
from manyhands._core.pybullet import COV_ENABLE_GUI, COV_ENABLE_SHADOWS, COV_ENABLE_WIREFRAME
from manyhands.pybullet.camera import PageCamera
from manyhands.pybullet.events import Keys, Mouse
from manyhands.pybullet.parameters import Parameters
from manyhands.pybullet.source import ClientSource
from manyhands.viewer import view
from manyhands.viewer.notebook import has_screen, is_notebook, show_in_cell

_POINT = 0.004  # [m]: a point of size 1


class Page:
    """Draws in the viewer's thread, as often as that has time."""

    def __init__(self, client: int, *, opens: bool = True) -> None:
        """opens: whether the browser is opened, or a notebook shows the page, where there is a screen or one. Raises
        ModuleNotFoundError without the extra `viewer`."""
        self._client, self._source = client, ClientSource(client)
        in_notebook = opens and is_notebook()
        # Whoever opens the page rules over the program; other people on this machine may not.
        self.viewer = view(
            self._source, token=secrets.token_urlsafe(16), open_browser=opens and has_screen() and not in_notebook
        )
        if in_notebook:
            show_in_cell(self.viewer)
        self._drawn: set[int] = set()
        self._painted: tuple[Any, ...] = ()
        self._switches: dict[int, bool] = {}
        self._background: Any = None
        self._camera = PageCamera(client, self.viewer)
        self._parameters = Parameters(client, self.viewer.server)
        self._keys, self._mouse = Keys(client, self.viewer.server), Mouse(client, self.viewer.server)
        self.viewer.on_draw.append(self._draw)

    def close(self) -> None:
        """Takes the page away."""
        self.viewer.close()

    def _draw(self) -> None:
        frame = self._source.frame
        self._paint(frame)
        self._draw_items(frame)
        self._parameters.show(frame)
        self._switch(frame)
        self._camera.follow(frame)
        if frame.listens_to_keys:
            self._keys.pass_on()
        if frame.listens_to_mouse:
            self._mouse.pass_on()

    def _paint(self, frame: pybullet_gui.ScreenFrame) -> None:
        """Colours as they are now; those of the model are the files'."""
        if self._painted != (frame.scene, frame.looks):
            self._painted = frame.scene, frame.looks
            self.viewer.stage.paint(self._source.rgba)

    def _draw_items(self, frame: pybullet_gui.ScreenFrame) -> None:
        for gone in self._drawn - {*frame.ids}:
            self.viewer.erase(f"item {gone}")
            self._drawn.remove(gone)
        for number, item in frame.items:
            if item.kind != "parameter":
                self._draw_item(f"item {number}", item)
                self._drawn.add(number)
        self._source.seen = frame.serial

    def _draw_item(self, name: str, item: pybullet_gui.DebugItem) -> None:
        overlays = self.viewer.overlays
        colors = np.round(255 * np.clip(item.colours, 0, 1)).astype(np.uint8)
        if item.kind == "line":
            r, g, b = colors[0].tolist()
            overlays.line(name, item.points, (r, g, b), item.size)
        elif item.kind == "text":
            overlays.text(name, item.text, item.points[0], item.size)
        else:
            overlays.points(name, item.points, colors, _POINT * item.size)

    def _switch(self, frame: pybullet_gui.ScreenFrame) -> None:
        changed = {flag: on for flag, on in frame.switches.items() if self._switches.get(flag) != on}
        self._switches = frame.switches
        stage, panel = self.viewer.stage, self.viewer.server.gui.main_panel
        if COV_ENABLE_SHADOWS in changed:
            stage.shadows = changed[COV_ENABLE_SHADOWS]
        if COV_ENABLE_WIREFRAME in changed:
            stage.wireframe = changed[COV_ENABLE_WIREFRAME]
        if COV_ENABLE_GUI in changed:
            panel.expand() if changed[COV_ENABLE_GUI] else panel.minimize()
        if frame.background is not None and frame.background != self._background:
            self._background = frame.background
            stage.set_background(np.array(frame.background))
