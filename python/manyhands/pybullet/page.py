"""The page of one client with a window: its bodies, and what the program draws and asks for besides."""

from typing import Any

import numpy as np

from manyhands._core import pybullet_gui
from manyhands._core.pybullet import COV_ENABLE_GUI, COV_ENABLE_SHADOWS
from manyhands.pybullet.events import Keys, Mouse
from manyhands.pybullet.parameters import Parameters
from manyhands.pybullet.source import ClientSource
from manyhands.viewer import view

_POINT = 0.004  # [m]: a point of size 1


class Page:
    """Draws in the viewer's thread, as often as that has time."""

    def __init__(self, client: int, *, open_browser: bool = False, port: int = 8080) -> None:
        """Raises ModuleNotFoundError without the extra `viewer`."""
        self._client, self._source = client, ClientSource(client)
        self.viewer = view(self._source, open_browser=open_browser, port=port)
        self._drawn: set[int] = set()
        self._painted: tuple[Any, ...] = ()
        self._switches: dict[int, bool] = {}
        self._camera_moves, self._cameras = -1, {}
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
        self._move_camera(frame)
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
        changed = {flag for flag, on in frame.switches.items() if self._switches.get(flag, True) != on}
        self._switches = frame.switches
        if COV_ENABLE_SHADOWS in changed:
            self.viewer.stage.shadows = frame.switches[COV_ENABLE_SHADOWS]
        if COV_ENABLE_GUI in changed:
            panel = self.viewer.server.gui.main_panel
            panel.expand() if frame.switches[COV_ENABLE_GUI] else panel.minimize()

    def _move_camera(self, frame: pybullet_gui.ScreenFrame) -> None:
        """To where the program puts it; and tells the program where people have moved it."""
        if frame.camera_moves != self._camera_moves:
            self._camera_moves = frame.camera_moves
            self.viewer.look(frame.eye, frame.target)
        for number, browser in self.viewer.server.get_clients().items():
            moved, camera = self._cameras.get(number), browser.camera
            if moved is None or moved != camera.update_timestamp:
                self._cameras[number] = camera.update_timestamp
                at: Any = camera.position.tolist()
                to: Any = camera.look_at.tolist()
                pybullet_gui.set_camera(self._client, at, to)
