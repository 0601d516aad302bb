"""What is drawn over the bodies: contacts, trails, lines and text."""

from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Contact

Array = NDArray[np.float64]
Color = tuple[int, int, int]

_POINT, _NORMAL, _PUSH, _TRAIL = (230, 70, 40), (30, 120, 220), (150, 60, 200), (20, 150, 120)
_LONGEST_TRAIL = 600  # points
_TRAIL_STEP = 0.002  # [m]
_REACH = 0.25  # of the arrow of the largest force [m]


class Overlays:
    """Drawings by name; one of the same name replaces the older."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._scene = server.scene
        self._contacts: Any = None
        self._forces: Any = None
        self._push: Any = None
        self._trails: dict[str, deque[Array]] = {}
        self._lines: dict[str, Any] = {}
        self._styles: dict[str, tuple[Any, ...]] = {}  # of lines and text: what cannot be changed without drawing anew
        self.shows_points = False
        self.shows_forces = False
        self.force_scale = 0.01
        """Length of a force's arrow [m/N]."""

    # ---- contacts ------------------------------------------------------------------------------------------------

    def show_contacts(self, contacts: Sequence[Contact]) -> None:
        """Points, and arrows along the forces, as chosen."""
        points = np.array([c.position for c in contacts], np.float64).reshape(-1, 3)
        _remove(self._contacts)
        self._contacts = None
        if self.shows_points and len(points):
            self._contacts = self._scene.add_point_cloud(
                "/contacts/points", points, _POINT, point_size=0.008, point_shape="circle"
            )
        forces = np.array([c.force for c in contacts], np.float64).reshape(-1, 3)
        self._forces = self._arrows("/contacts/forces", self._forces, self.shows_forces, points, forces, _NORMAL)

    def show_push(self, point: Array | None, force: Array | None) -> None:
        """The force by which somebody pulls; None for none."""
        is_there = point is not None and force is not None
        at = np.zeros((1, 3)) if point is None else point[None]
        by = np.zeros((1, 3)) if force is None else force[None]
        self._push = self._arrows("/push", self._push, is_there, at, by, _PUSH)

    def _arrows(self, name: str, old: Any, shown: bool, points: Array, forces: Array, color: Color) -> Any:
        lengths = np.linalg.norm(forces, axis=1)
        keep = lengths * self.force_scale > 1e-3
        if not shown or not keep.any():
            _remove(old)
            return None
        scale = np.minimum(self.force_scale, _REACH / np.maximum(lengths[keep], 1e-9))
        tips = points[keep] + forces[keep] * scale[:, None]
        rows = np.stack([points[keep], tips], 1).astype(np.float32)
        if old is not None and len(old.points) == len(rows):
            old.points = rows
            return old
        _remove(old)
        return self._scene.add_arrows(name, rows, color, shaft_radius=0.003, head_radius=0.008, head_length=0.018)

    # ---- trails --------------------------------------------------------------------------------------------------

    @property
    def trails(self) -> list[str]:
        """The links that leave one."""
        return list(self._trails)

    def add_trail(self, link: str) -> None:
        """Draws where the origin of a link has been."""
        self._trails.setdefault(link, deque(maxlen=_LONGEST_TRAIL))

    def remove_trail(self, link: str) -> None:
        self._trails.pop(link, None)
        self.remove(f"trail {link}")

    def clear_trails(self) -> None:
        """Begins them anew."""
        for link, points in self._trails.items():
            points.clear()
            self.remove(f"trail {link}")

    def extend_trails(self, positions: dict[str, Array]) -> None:
        """Adds where links are now (3)."""
        for link, points in self._trails.items():
            position = positions.get(link)
            if position is None or (points and np.linalg.norm(position - points[-1]) < _TRAIL_STEP):
                continue
            points.append(position.copy())
            if len(points) > 1:
                self.line(f"trail {link}", points, _TRAIL, 3.0)

    # ---- lines and text ------------------------------------------------------------------------------------------

    def line(self, name: str, points: ArrayLike, color: Color, width: float) -> None:
        """A line through points (n, 3) [m]."""
        path = np.asarray(points, np.float32).reshape(-1, 3)
        segments = np.stack([path[:-1], path[1:]], 1)
        old = self._same(name, ("line", len(segments), color, width))
        if old is not None:
            old.points = segments
            return
        self._lines[name] = self._scene.add_line_segments(
            _path(name), segments, color, thickness=width, thickness_units="screen"
        )

    def text(self, name: str, text: str, position: ArrayLike, size: float = 1.0) -> None:
        """A label at a place (3) [m]; its size is relative to the usual one."""
        place = np.asarray(position, np.float64)
        old = self._same(name, ("text", text, size))
        if old is not None:
            old.position = place
            return
        self._lines[name] = self._scene.add_label(
            _path(name), text, position=place, anchor="bottom-center", font_screen_scale=size
        )

    def points(self, name: str, points: ArrayLike, colors: NDArray[np.uint8], size: float) -> None:
        """Points (n, 3) [m] of colours (n, 3), each of a size [m]."""
        places = np.asarray(points, np.float32).reshape(-1, 3)
        self._styles.pop(name, None)
        self._lines[name] = self._scene.add_point_cloud(
            _path(name), places, colors, point_size=size, point_shape="circle", precision="float32"
        )

    def axes(self, name: str, position: ArrayLike, quaternion: ArrayLike, size: float) -> None:
        """A frame at a pose (3), xyzw (4); its axes have a length [m]."""
        wxyz = np.asarray(quaternion, np.float64)[[3, 0, 1, 2]]
        self._styles.pop(name, None)
        self._lines[name] = self._scene.add_frame(
            _path(name), axes_length=size, axes_radius=size / 30, position=np.asarray(position, np.float64), wxyz=wxyz
        )

    def remove(self, name: str) -> None:
        """Passes over what is not there."""
        self._styles.pop(name, None)
        _remove(self._lines.pop(name, None))

    def _same(self, name: str, style: tuple[Any, ...]) -> Any:
        """What is drawn under that name already, if its style is the same; else None, and the style is remembered."""
        if self._styles.get(name) == style:
            return self._lines[name]
        self._styles[name] = style
        return None


def _path(name: str) -> str:
    return f"/drawn/{name.replace('/', ' ')}"


def _remove(handle: Any) -> None:
    if handle is not None:
        handle.remove()
