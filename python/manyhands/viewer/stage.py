"""Bodies, ground and light in the browser."""

from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from manyhands._core import Model
from manyhands.measures import rotate
from manyhands.viewer import shapes
from manyhands.viewer.neighbours import NeighbourStage, places
from manyhands.viewer.player import Frame
from manyhands.viewer.sources import DragKey, Marker

Array = NDArray[np.float64]
DragHandler = Callable[[str, Any], None]

_SKY, _HAZE = np.array([150, 168, 186]), np.array([214, 222, 230])
_GROUND, _LINES, _SECTIONS = (150, 160, 170), (170, 180, 190), (196, 206, 214)
_COLLISION = (255, 140, 60)
_WIDE = 1.0  # a fixed flat box of more than this half extent [m] is ground
_VAST = 10.0  # so is one of more than this that a user might move, but nobody does
_SMALL = 0.06  # what is not larger [m] receives no shadows: their coarse map would draw bands along its edges
_STILL = 1e-7  # what has moved by less [m], or of its quaternion, is not told to browsers
_GLASS = 0.35  # opacity of goals


class Stage:
    """A scene of viser's that follows the bodies of a model.

    Links with visual shapes show these, others what they collide with. `on_drag` hears of drags of bodies with the
    left button, a key held: the link's name and viser's event.
    """

    def __init__(
        self, server: viser.ViserServer, on_drag: DragHandler | None = None, drag_key: DragKey = "cmd/ctrl"
    ) -> None:
        """drag_key: viser's name of the key; None: none may be held."""
        self._scene, self._on_drag = server.scene, on_drag
        self._drag_key: DragKey = drag_key
        self._bodies: list[viser.FrameHandle] = []
        self._collision: list[viser.MeshHandle] = []
        self._surfaces: dict[int, viser.MeshHandle] = {}  # by numbers of geoms
        self._poses = np.zeros((0, 7))
        self._corners: list[tuple[int, Array]] = []
        self._standing: set[int] = set()
        self._markers: dict[str, viser.MeshHandle] = {}
        self._shows_collision = self._wireframe = False
        self.neighbours = NeighbourStage(self._scene)
        self.index: dict[str, int] = {}
        """Of the links, by name."""
        self.center = np.zeros(3)
        self.radius = 1.0
        self._light()

    def _light(self) -> None:
        # A large soft light from above, a key light with shadows, and the sky's blue from behind.
        scene = self._scene
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map("studio", environment_intensity=0.12)
        scene.add_light_hemisphere("/light/sky", sky_color=(255, 255, 255), ground_color=(140, 142, 150), intensity=0.5)
        self._key_light = scene.add_light_directional(
            "/light/key", color=(255, 246, 234), intensity=2.1, cast_shadow=True, position=(1.2, -1.0, 2.4)
        )
        scene.add_light_directional("/light/rim", color=(214, 230, 255), intensity=0.25, position=(-1.5, 1.6, 1.2))
        height = np.linspace(0, 1, 256)[:, None, None]
        sky = _SKY + (_HAZE - _SKY) * np.clip(height * 1.6, 0, 1)
        self._paint(sky)

    def set_background(self, color: Array) -> None:
        """A colour (3), 0 to 1, in place of the sky."""
        self._paint(np.rint(255 * np.clip(color, 0, 1)))

    def _paint(self, rows: Array) -> None:
        """The background, from the top: colours (256, 1, 3) or (3), 0 to 255."""
        image = np.broadcast_to(rows, (256, 4, 3)).astype(np.uint8)
        self._scene.set_background_image(image, format="png")

    # ---- bodies ------------------------------------------------------------------------------------------------

    def build(self, model: Model, positions: Array, quaternions: Array) -> None:
        """Replaces all bodies by those of a model, at the poses of its links (n, 3), (n, 4)."""
        for handle in self._bodies:
            handle.remove()
        self._bodies, self._collision, self._corners, self._surfaces = [], [], [], {}
        self.index = {link.name: index for index, link in enumerate(model.links)}
        height, ground = _ground(model, positions)
        self._draw_ground(height)
        for index, link in enumerate(model.links):
            body = self._scene.add_frame(f"/bodies/{index} {link.name.replace('/', ' ')}", show_axes=False)
            body.axes_length, body.axes_radius = 0.1, 0.003
            self._bodies.append(body)
        self._standing = _standing(model)
        seen = {geom.link for geom in model.geoms if geom.is_visual}
        shown: list[int] = []
        for number, geom in enumerate(model.geoms):
            hides = not geom.is_visual and geom.link in seen
            if number not in ground and self._add_geom(model, number, hides) and not hides:
                shown.append(number)
        self.neighbours.build(model, shown)
        self._measure(model, positions, quaternions, ground)
        self._poses = np.full((len(self._bodies), 7), np.nan)
        self.show(positions, quaternions)

    def show(self, positions: Array, quaternions: Array) -> None:
        """Puts the links at poses (n, 3), xyzw (n, 4)."""
        poses = np.hstack([positions, quaternions])
        moved = ~(np.abs(poses - self._poses) < _STILL).all(1)
        self._poses[moved] = poses[moved]
        for index in np.flatnonzero(moved):
            body = self._bodies[index]
            body.position, body.wxyz = positions[index], quaternions[index][[3, 0, 1, 2]]

    def paint(self, rgba: NDArray[np.floating]) -> None:
        """Gives the geoms other colours (n, 4)."""
        for number, handle in self._surfaces.items():
            handle.color, handle.opacity = shapes.color(rgba[number]), _opacity(rgba[number])

    def show_markers(self, markers: list[Marker]) -> None:
        """Goals: as glassy shapes."""
        for name in self._markers.keys() - {marker.name for marker in markers}:
            self._markers.pop(name).remove()
        for marker in markers:
            if marker.name not in self._markers:
                size = np.array([*marker.size, 0.0, 0.0])[:3]
                surface = shapes.primitive(marker.shape, size)
                self._markers[marker.name] = self._scene.add_mesh_simple(
                    f"/goals/{marker.name}", surface.vertices, surface.triangles, color=shapes.color(marker.rgba),
                    opacity=_GLASS, cast_shadow=False, receive_shadow=False,
                )  # fmt: skip
            handle = self._markers[marker.name]
            handle.position, handle.wxyz = marker.position, marker.quaternion[[3, 0, 1, 2]]

    def placed(self, frame: Frame) -> Iterator[tuple[str, Array, Array]]:
        """The nodes of the scene that move, and where a frame has them: position (3), xyzw (4)."""
        for body, position, quaternion in zip(self._bodies, frame.positions, frame.quaternions, strict=True):
            yield body.name, position, quaternion
        for marker in frame.markers:
            if marker.name in self._markers:
                yield self._markers[marker.name].name, marker.position, marker.quaternion

    def show_frames(self, links: set[int]) -> None:
        """Shows the axes of these links, hides the others'."""
        for index, body in enumerate(self._bodies):
            body.show_axes = index in links

    @property
    def shadows(self) -> bool:
        """Whether bodies cast them."""
        return self._key_light.cast_shadow

    @shadows.setter
    def shadows(self, on: bool) -> None:
        self._key_light.cast_shadow = on

    @property
    def wireframe(self) -> bool:
        """Whether edges are drawn and no faces."""
        return self._wireframe

    @wireframe.setter
    def wireframe(self, on: bool) -> None:
        self._wireframe = on
        for handle in self._surfaces.values():
            handle.wireframe = on

    @property
    def shows_collision(self) -> bool:
        """Whether shapes that collide are shown over those that are seen."""
        return self._shows_collision

    @shows_collision.setter
    def shows_collision(self, on: bool) -> None:
        self._shows_collision = on
        for handle in self._collision:
            handle.visible = on

    def camera(self, worlds: int = 1) -> tuple[Array, Array]:
        """Where to look from, and at, to see all that moves, or so many worlds beside each other: positions (3)."""
        around = places(worlds)
        look_at = self.center + around.mean(0)
        radius = self.radius + 0.45 * float(np.linalg.norm(np.ptp(around, axis=0)))
        return look_at + radius * np.array([1.55, -1.75, 1.0]), look_at

    def _add_geom(self, model: Model, number: int, hides: bool) -> bool:
        """A geom on its link's body, if there is anything to see of it; `hides`: a shape that only collides, on a body
        that shows others."""
        geom, body = model.geoms[number], self._bodies[model.geoms[number].link]
        surface = shapes.surface(model, geom)
        if surface is None or not len(surface.triangles):
            return False
        if model.links[geom.link].body > 0:
            low, high = surface.vertices.min(0), surface.vertices.max(0)
            corners = np.array(list(product(*zip(low, high, strict=True))), np.float64)
            self._corners.append((geom.link, geom.position + rotate(geom.quaternion, corners)))
        is_small = bool(np.ptp(surface.vertices, axis=0).max() <= _SMALL)
        handle = self._scene.add_mesh_simple(
            f"{body.name}/{number}", surface.vertices, surface.triangles,
            color=_COLLISION if hides else shapes.color(geom.rgba),
            opacity=0.35 if hides else _opacity(geom.rgba),
            cast_shadow=not hides, receive_shadow=not (hides or is_small),
            side="double" if geom.shape == "height_field" else "front", wireframe=self._wireframe,
            position=geom.position, wxyz=geom.quaternion[[3, 0, 1, 2]], visible=not hides or self._shows_collision,
        )  # fmt: skip
        if hides:
            self._collision.append(handle)
            return True
        self._surfaces[number] = handle
        if self._on_drag is not None and model.links[geom.link].body not in self._standing:
            link, on_drag = model.links[geom.link].name, self._on_drag

            # Coroutines are run in the order of the events; plain functions are not.
            async def dragged(event: Any) -> None:
                on_drag(link, event)

            handle.on_drag("left", modifier=self._drag_key)(dragged)
        return True

    def _draw_ground(self, height: float) -> None:
        self._scene.add_grid(
            "/ground", infinite_grid=True, cell_size=0.1, section_size=0.5, cell_color=_LINES, section_color=_SECTIONS,
            cell_thickness=0.7, section_thickness=1.0, fade_distance=9.0, fade_strength=1.6, shadow_opacity=0.45,
            plane_color=_GROUND, plane_opacity=1.0, position=(0.0, 0.0, height - 5e-4),
        )  # fmt: skip

    def _measure(self, model: Model, positions: Array, quaternions: Array, ground: set[int]) -> None:
        """A ball about all that is not ground: about the shapes of what moves, and the places of what stands."""
        points = [
            positions[geom.link]
            for number, geom in enumerate(model.geoms)
            if number not in ground and geom.shape not in ("plane", "height_field")
        ]
        for link, corners in self._corners:
            points += list(positions[link] + rotate(quaternions[link], corners))
        if points:
            low, high = np.min(points, 0), np.max(points, 0)
            self.center = (low + high) / 2
            self.radius = float(np.clip(np.linalg.norm(high - low) / 2 + 0.15, 0.4, 5.0))


def _opacity(rgba: Any) -> float | None:
    """None of what cannot be looked through."""
    return float(rgba[3]) if rgba[3] < 1 else None


def _ground(model: Model, positions: Array) -> tuple[float, set[int]]:
    """The height of the ground, and the geoms that it stands for."""
    standing = _standing(model)
    for number, geom in enumerate(model.geoms):
        is_level = abs(abs(geom.quaternion[3]) - 1) < 1e-6
        if not is_level or geom.shape not in ("plane", "box") or model.links[geom.link].body not in standing:
            continue
        height = float(positions[geom.link][2] + geom.position[2])
        if geom.shape == "plane":
            return height, _shown_as(model, number)
        if min(geom.size[:2]) > (_WIDE if model.links[geom.link].body == 0 else _VAST):
            return height + float(geom.size[2]), _shown_as(model, number)
    return min(0.0, float(positions[:, 2].min(initial=0.0))), set()


def _standing(model: Model) -> set[int]:
    """The bodies that nothing moves but a user."""
    set_by_users = {link.body for link in model.links if link.joint >= 0 and model.joints[link.joint].type == "mocap"}
    return {0} | set_by_users


def _shown_as(model: Model, ground: int) -> set[int]:
    """The ground, and what its link shows in its place: the same shape, or a square."""
    held = model.geoms[ground]

    def is_it(geom: Any) -> bool:
        if geom.shape == "mesh":
            surface = shapes.surface(model, geom)
            return surface is not None and len(surface.triangles) <= 2
        return geom.shape == held.shape and np.allclose(geom.size, held.size)

    return {number for number, geom in enumerate(model.geoms) if geom.link == held.link and is_it(geom)}
