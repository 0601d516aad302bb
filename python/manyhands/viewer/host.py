"""What the panels know of the viewer that they are part of."""

from typing import Protocol

import viser
from numpy.typing import ArrayLike

from manyhands.viewer.overlays import Overlays
from manyhands.viewer.player import Player
from manyhands.viewer.sources import Source
from manyhands.viewer.stage import Stage


class Host(Protocol):
    """A `Viewer`; its members are described there."""

    source: Source
    server: viser.ViserServer
    overlays: Overlays
    stage: Stage
    player: Player
    pull: float

    @property
    def speed(self) -> float: ...

    @speed.setter
    def speed(self, speed: float) -> None: ...

    def play(self) -> None: ...

    def pause(self) -> None: ...

    def step(self, n: int = 1) -> None: ...

    def reset(self) -> None: ...

    def look(self, position: ArrayLike, look_at: ArrayLike) -> None: ...
