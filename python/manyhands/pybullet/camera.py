"""The camera of a page, which the program and people move."""

from typing import TYPE_CHECKING, Any

import numpy as np

from manyhands._core import pybullet_gui

if TYPE_CHECKING:
    from manyhands.viewer import Viewer

_FIELD = np.radians(90.0)  # of view, as in PyBullet's window, so that distances mean the same


class PageCamera:
    """Until the program or somebody has moved it, it shows all that there is, from where PyBullet's window looks."""

    def __init__(self, client: int, viewer: "Viewer") -> None:
        self._client, self._viewer, self._server = client, viewer, viewer.server
        self._moves, self._scene = 0, -1
        self._seen: dict[int, Any] = {}  # browsers, and when they told of their camera
        self._put: Any = None  # where the page has put it
        self._server.initial_camera.fov = _FIELD

    def follow(self, frame: pybullet_gui.ScreenFrame) -> None:
        """Puts it where the program wants it; tells the program where people have moved it."""
        if frame.camera_moves != self._moves:
            self._moves = frame.camera_moves
            self._viewer.look(frame.eye, frame.target)
        elif self._moves == 0 and frame.scene != self._scene and self._is_untouched(frame):
            self._show_all(frame)
        self._scene = frame.scene
        for number, browser in self._server.get_clients().items():
            camera = browser.camera
            if self._seen.get(number) != camera.update_timestamp:
                self._seen[number] = camera.update_timestamp
                at: Any = camera.position.tolist()
                to: Any = camera.look_at.tolist()
                pybullet_gui.set_camera(self._client, at, to, self._moves)
                pybullet_gui.set_size(self._client, camera.image_width, camera.image_height)

    def _show_all(self, frame: pybullet_gui.ScreenFrame) -> None:
        stage = self._viewer.stage
        away = np.subtract(frame.eye, frame.target)
        eye = stage.center + 1.6 * stage.radius * away / np.linalg.norm(away)
        self._viewer.look(eye, stage.center)
        self._put = eye

    def _is_untouched(self, frame: pybullet_gui.ScreenFrame) -> bool:
        """Whether nobody has moved it since the page has put it somewhere."""
        return self._put is None or not self._seen or np.allclose(frame.eye, self._put, atol=1e-3)
