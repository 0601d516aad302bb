"""The tab with pictures of cameras in the scene."""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from manyhands._core.render import Camera, Look, Mark, Renderer
from manyhands.measures import hand_of
from manyhands.viewer.host import Host
from manyhands.viewer.player import Frame
from manyhands.viewer.sources import Source

Picture = Callable[[], NDArray[np.uint8] | None]

_NOTHING = "none"
_WIDTH, _HEIGHT, _FOV = 320, 240, 0.9
_EVERY = 0.4  # [s] between two pictures, which cost up to 20 ms each
_LOOK = Look(antialiasing=2, shadow_rays=1)


class CameraPanel:
    """One picture at a time, taken only while it is chosen."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer, self._waits, self._last = viewer, False, -math.inf
        self._eye = _Eye(viewer.source)
        self._cameras: dict[str, Picture] = {
            name: self._eye.through(camera) for name, camera in self._usual(viewer).items()
        }
        gui = viewer.server.gui
        with tabs.add_tab("Cameras"):
            first = next(name for name in ("hand", "front") if name in self._cameras)
            self._choice: Any = gui.add_dropdown("Camera", (_NOTHING, *self._cameras), initial_value=first)
            self._image = gui.add_image(np.full((_HEIGHT, _WIDTH, 3), 235, np.uint8))

    def add(self, name: str, camera: Camera | Picture) -> None:
        """Offers what a camera sees, or pictures (h, w, 3) that come from elsewhere."""
        self._cameras[name] = self._eye.through(camera) if isinstance(camera, Camera) else camera
        self._choice.options = (_NOTHING, *self._cameras)

    def _usual(self, viewer: Host) -> dict[str, Camera]:
        eye, center = viewer.stage.camera()
        camera = Camera.perspective(_WIDTH, _HEIGHT, _FOV)
        above = center + np.array([0.0, 0.0, 2.4 * viewer.stage.radius])
        cameras = {
            "front": camera.look_at(eye.tolist(), center.tolist()),
            "top": camera.look_at(above.tolist(), center.tolist(), up=[1.0, 0.0, 0.0]),
        }
        if (hand := hand_of(viewer.source.model)) is not None:
            behind = [0.08, 0.0, -0.09]  # most hands point along their z axis
            cameras["hand"] = camera.look_at(behind, [0.02, 0.0, 0.1], up=[1.0, 0.0, 0.0], frame=hand)
        return cameras

    def refresh(self, _: Frame) -> None:
        """Asks for the next picture, unless the last one is still being taken, or nobody has the page open."""
        picture, now = self._cameras.get(self._choice.value), time.perf_counter()
        if picture is None or self._waits or now - self._last < _EVERY or not self._viewer.server.get_clients():
            return
        self._waits, self._last = True, now

        def take() -> None:
            try:
                pixels = picture()
            finally:
                self._waits = False
            if pixels is not None:
                self._image.image = np.asarray(pixels)[..., :3]

        self._viewer.player.do(take)


class _Eye:
    """Takes pictures of what a source shows, goals included."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._parts: tuple[Any, ...] = ()
        self._renderer: Renderer | None = None

    def through(self, camera: Camera) -> Picture:
        """What takes pictures by a camera, to be called between two steps."""

        def take() -> NDArray[np.uint8]:
            source = self._source
            if self._renderer is None or source.parts() != self._parts:
                self._parts, self._renderer = source.parts(), Renderer(source.model, 1)
            marks = [
                Mark(m.shape, list(m.size), m.position.tolist(), m.quaternion.tolist(), list(m.rgba))
                for m in source.markers()
            ]
            picture = self._renderer.render(
                source.q, camera, mocap=source.mocap, look=_LOOK, marks=marks, depth=False, segmentation=False
            )
            return picture.colour

        return take
