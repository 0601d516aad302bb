"""A client, as the viewer sees it: copies of what it shows, never its world itself."""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Model, pybullet_gui
from manyhands._core.pybullet import COV_ENABLE_MOUSE_PICKING, COV_ENABLE_RENDERING, error
from manyhands.viewer.sources import Source

Array = NDArray[np.float64]

_LONGEST_WAIT = 1.0  # [s] for bodies to stop coming and going before they are drawn


class ClientSource(Source):
    """What a client shows, taken between two of its steps while its program goes on."""

    moves = False
    only_watched = True
    drag_key = None  # as in PyBullet's window

    def __init__(self, client: int) -> None:
        super().__init__()
        self.client, self.title, self.dt = client, f"PyBullet client {client}", 1 / 240
        self.seen = -1
        """Up to which change of items they have been drawn."""
        self._coming, self._holds = -1, False
        self._take(pybullet_gui.frame(client))

    def _take(self, frame: pybullet_gui.ScreenFrame) -> None:
        self.frame = frame
        self._poses = frame.positions, frame.quaternions
        if frame.model is not None:
            self._model, self._built = frame.model, time.perf_counter()
        if frame.model is not None or len(frame.rgba):
            self.rgba = frame.rgba

    def refresh(self) -> None:
        try:
            self._hold()
            self._look()
        except error:
            return  # it has just been disconnected, and the page is about to go

    def _look(self) -> None:
        frame = pybullet_gui.frame(self.client, self.seen, self.frame.looks, False)
        if not frame.switches.get(COV_ENABLE_RENDERING, True):
            return
        if frame.scene == self.frame.scene:
            self._take(frame)
            return
        is_settled = frame.scene == self._coming or time.perf_counter() - self._built > _LONGEST_WAIT
        self._coming = frame.scene
        if is_settled:
            self._take(pybullet_gui.frame(self.client, self.seen, -1, True))

    def _hold(self) -> None:
        """Passes on what people drag, and where to."""
        held = list(self.pushes.values()) if self.frame.switches.get(COV_ENABLE_MOUSE_PICKING, True) else []
        if held or self._holds:
            self._holds = bool(held)
            grips: Any = [(push.link, push.point.tolist(), push.target.tolist()) for push in held]
            pybullet_gui.hold(self.client, grips)

    @property
    def model(self) -> Model:
        return self._model

    @property
    def q(self) -> Array:
        return self.frame.q

    @property
    def time(self) -> float:
        return self.frame.time

    @property
    def can_be_pulled(self) -> bool:
        return True

    def parts(self) -> tuple[Any, ...]:
        return (self.frame.scene,)

    def poses(self) -> tuple[Array, Array]:
        return self._poses

    def step(self) -> None:
        """The program steps."""

    def reset(self) -> None:
        """The program resets."""

    def save(self) -> None:
        """The program goes on; it is never gone back."""

    def restore(self, state: Any) -> None:
        """As `save`."""
