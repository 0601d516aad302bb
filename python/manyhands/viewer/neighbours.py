"""The worlds beside the one that is shown."""

import math
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from manyhands import rotations
from manyhands._core import Model
from manyhands.measures import rotate
from manyhands.viewer import shapes
from manyhands.viewer.sources import Marker

Array = NDArray[np.float64]

_APART = np.array([-1.8, 1.5, 0.0])  # of worlds, away from who looks [m]
_GLASS = 0.35  # opacity of goals
_ABOVE = np.array([-0.6, 0.0, 0.85])  # where a world's number stands [m]


class Neighbours(NamedTuple):
    """n worlds of one model."""

    worlds: list[int]
    """Their numbers."""
    positions: Array
    """(n, links, 3) [m], each in its world."""
    quaternions: Array
    """(n, links, 4) xyzw"""
    markers: list[list[Marker]]
    """Goals of each world."""


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
        self._surfaces: dict[int, shapes.Surface] = {}
        self._batches: dict[str, viser.BatchedMeshHandle] = {}
        self._labels: list[viser.LabelHandle] = []
        self._worlds: list[int] = []

    def build(self, model: Model, geoms: list[int]) -> None:
        """These geoms of a model's are drawn from now on, once there are neighbours."""
        self._clear()
        self._model, self._geoms, self._surfaces = model, geoms, {}

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
        for number in self._geoms:
            self._show_geom(self._model, number, shown, apart)
        for marker, *_ in zip(*shown.markers[1:], strict=True):
            same = [each for markers in shown.markers[1:] for each in markers if each.name == marker.name]
            surface = shapes.primitive(marker.shape, np.array([*marker.size, 0.0, 0.0])[:3])
            positions = apart + [each.position for each in same]
            self._draw(f"goals/{marker.name}", surface, positions, np.array([m.quaternion for m in same]), marker.rgba)

    def _show_geom(self, model: Model, number: int, shown: Neighbours, apart: Array) -> None:
        geom = model.geoms[number]
        if number not in self._surfaces:
            surface = shapes.surface(model, geom)
            assert surface is not None
            self._surfaces[number] = surface
        turned, at = shown.quaternions[1:, geom.link], shown.positions[1:, geom.link]
        positions = apart + at + rotate(turned, geom.position)
        # The product of quaternions is linear in the first.
        quaternions = turned @ np.array([rotations.multiply(unit, geom.quaternion) for unit in np.eye(4)])
        self._draw(str(number), self._surfaces[number], positions, quaternions, (*geom.rgba[:3], 1.0))

    def _draw(
        self, name: str, surface: shapes.Surface, positions: Array, quaternions: Array, rgba: tuple[float, ...]
    ) -> None:
        wxyzs = np.roll(quaternions, 1, -1).astype(np.float32)
        places = positions.astype(np.float32)
        batch = self._batches.get(name)
        if batch is None:
            self._batches[name] = self._scene.add_batched_meshes_simple(
                f"/beside/{name}", surface.vertices, surface.triangles, wxyzs, places,
                batched_colors=shapes.color(rgba), opacity=None if rgba[3] == 1 else _GLASS, cast_shadow=False,
                receive_shadow=False,
            )  # fmt: skip
            return
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
