"""The worlds beside the one that is shown."""

import math
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from manyhands import rotations
from manyhands._core import Model
from manyhands.measures import rotate
from manyhands.viewer import shapes
from manyhands.viewer.sources import Neighbours

Array = NDArray[np.float64]

_APART = np.array([-1.8, 1.5, 0.0])  # of worlds, away from who looks [m]
_GLASS = 0.35  # opacity of goals
_ABOVE = np.array([-0.6, 0.0, 0.85])  # where a world's number stands [m]


def places(count: int) -> Array:
    """Where worlds stand in a square (count, 3) [m]; the first stays where it is."""
    side = math.ceil(math.sqrt(count))
    return np.array([[k // side, k % side, 0.0] for k in range(count)]).reshape(-1, 3) * _APART


class NeighbourStage:
    """Draws all worlds but the first, each geom of theirs as one batch of meshes."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene = scene
        self._model: Model | None = None
        self._geoms: list[int] = []
        self._links: list[int] = []
        self._offsets, self._turns = np.zeros((0, 3)), np.zeros((0, 4, 4))
        self._batches: dict[str, viser.BatchedMeshHandle] = {}
        self._labels: list[viser.LabelHandle] = []
        self._worlds: list[int] = []

    def build(self, model: Model, geoms: list[int]) -> None:
        """These geoms of a model's are drawn from now on, once there are neighbours."""
        self._clear()
        self._model, self._geoms = model, geoms
        shown = [model.geoms[number] for number in geoms]
        self._links = [geom.link for geom in shown]
        self._offsets = np.array([geom.position for geom in shown]).reshape(-1, 3)
        # The product of quaternions is linear in the first.
        turns = [[rotations.multiply(unit, geom.quaternion) for unit in np.eye(4)] for geom in shown]
        self._turns = np.array(turns).reshape(-1, 4, 4)

    def show(self, shown: Neighbours | None) -> None:
        """Draws n - 1 of n worlds, or none."""
        worlds = [] if shown is None else shown.worlds
        if worlds != self._worlds:
            if len(worlds) != len(self._worlds):
                self._clear()
            self._worlds = worlds
            self._number()
        if shown is None or self._model is None:
            return
        apart = places(len(worlds))[1:]
        self._show_bodies(self._model, shown, apart)
        for marker, *_ in zip(*shown.markers[1:], strict=True):
            same = [each for markers in shown.markers[1:] for each in markers if each.name == marker.name]
            name = f"goals/{marker.name}"
            if name not in self._batches:
                surface = shapes.primitive(marker.shape, np.array([*marker.size, 0.0, 0.0])[:3])
                self._add(name, surface, len(same), marker.rgba, _GLASS)
            self._put(name, apart + [each.position for each in same], np.array([each.quaternion for each in same]))

    def _show_bodies(self, model: Model, shown: Neighbours, apart: Array) -> None:
        turned, at = shown.quaternions[1:, self._links], shown.positions[1:, self._links]
        positions = apart[:, None] + at + rotate(turned, self._offsets)
        quaternions = np.einsum("ngi,gij->ngj", turned, self._turns)
        for k, number in enumerate(self._geoms):
            name = str(number)
            if name not in self._batches:
                geom = model.geoms[number]
                surface = shapes.surface(model, geom)
                assert surface is not None
                self._add(name, surface, len(apart), geom.rgba, None)
            self._put(name, positions[:, k], quaternions[:, k])

    def _add(self, name: str, surface: shapes.Surface, count: int, rgba: Any, opacity: float | None) -> None:
        self._batches[name] = self._scene.add_batched_meshes_simple(
            f"/beside/{name}", surface.vertices, surface.triangles, np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
            np.zeros((count, 3)), batched_colors=shapes.color(rgba), opacity=opacity, cast_shadow=False,
            receive_shadow=False,
        )  # fmt: skip

    def _put(self, name: str, positions: Array, quaternions: Array) -> None:
        """Moves a batch to poses (n, 3), xyzw (n, 4); what stands still is not sent again."""
        batch, places = self._batches[name], positions.astype(np.float32)
        wxyzs = np.roll(quaternions, 1, -1).astype(np.float32)
        if not np.array_equal(batch.batched_positions, places):
            batch.batched_positions = places
        if not np.array_equal(batch.batched_wxyzs, wxyzs):
            batch.batched_wxyzs = wxyzs

    def _number(self) -> None:
        for label in self._labels:
            label.remove()
        self._labels = [
            self._scene.add_label(f"/beside/number {k}", str(world), position=place + _ABOVE)
            for k, (world, place) in enumerate(zip(self._worlds, places(len(self._worlds)), strict=True))
        ]

    def _clear(self) -> None:
        for batch in self._batches.values():
            batch.remove()
        self._batches = {}
