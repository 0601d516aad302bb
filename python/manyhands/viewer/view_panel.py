"""The tab with what is drawn, and from where."""

import io
from typing import Any

import numpy as np
import viser

from manyhands.measures import hand_of
from manyhands.viewer.host import Host

_DIRECTIONS = {
    "Corner": (1.55, -1.75, 1.0),
    "Front": (2.6, 0.0, 0.5),
    "Side": (0.0, -2.6, 0.5),
    "Top": (0.01, 0.0, 2.7),
}
_NOTHING, _ALL = "none", "all links"


class ViewPanel:
    """Contacts, frames, trails and shapes that collide; the camera; a picture to keep."""

    def __init__(self, viewer: Host, tabs: viser.GuiTabGroupHandle) -> None:
        self._viewer = viewer
        gui, overlays = viewer.server.gui, viewer.overlays
        with tabs.add_tab("View"):
            camera = gui.add_button_group("Camera", tuple(_DIRECTIONS))
            camera.on_click(lambda event: self._look_from(event.client, event.target.value))
            save = gui.add_button("Save a picture", icon=viser.Icon.CAMERA, hint="As PNG, in the size of your window")
            save.on_click(self._save)
            if viewer.source.world is not None:
                points = gui.add_checkbox("Contact points", False)
                points.on_update(lambda _: self._choose_contacts(points=points.value))
                forces = gui.add_checkbox("Contact forces", False)
                forces.on_update(lambda _: self._choose_contacts(forces=forces.value))
                scale = gui.add_slider("Arrow [mm/N]", 0.1, 50.0, 0.1, 1000 * overlays.force_scale)
                scale.on_update(lambda _: setattr(overlays, "force_scale", scale.value / 1000))
            shadows = gui.add_checkbox("Shadows", viewer.stage.shadows, hint="Off is faster without a graphics card")
            shadows.on_update(lambda _: setattr(viewer.stage, "shadows", shadows.value))
            collision = gui.add_checkbox("Collision shapes", False)
            collision.on_update(lambda _: setattr(viewer.stage, "shows_collision", collision.value))
            self._frames: Any = gui.add_dropdown("Axes", (_NOTHING,))
            self._frames.on_update(lambda _: self._choose_frames())
            self._trail: Any = gui.add_dropdown("Trail", (_NOTHING,))
            self._trail.on_update(lambda _: self._choose_trail())
        self.rebuild()

    def rebuild(self) -> None:
        """Names of the links that there are now."""
        model = self._viewer.source.model
        names = [link.name for link in model.links[1:]]
        if (hand := hand_of(model)) is not None:
            names = [hand, *(name for name in names if name != hand)]
        self._frames.options = (_NOTHING, _ALL, *names)
        self._trail.options = (_NOTHING, *names)

    def _choose_contacts(self, points: bool | None = None, forces: bool | None = None) -> None:
        overlays = self._viewer.overlays
        overlays.shows_points = overlays.shows_points if points is None else points
        overlays.shows_forces = overlays.shows_forces if forces is None else forces
        self._viewer.player.wants_contacts = overlays.shows_points or overlays.shows_forces

    def _choose_frames(self) -> None:
        index, name = self._viewer.stage.index, self._frames.value
        shown = set(index.values()) if name == _ALL else {index[name]} if name in index else set()
        self._viewer.stage.show_frames(shown)

    def _choose_trail(self) -> None:
        overlays, name = self._viewer.overlays, self._trail.value

        def choose() -> None:
            for link in overlays.trails:
                overlays.remove_trail(link)
            if name != _NOTHING:
                overlays.add_trail(name)

        self._viewer.player.do(choose)

    def _look_from(self, client: Any, direction: str) -> None:
        if client is None:
            return
        stage = self._viewer.stage
        with client.atomic():
            client.camera.position = stage.center + stage.radius * np.array(_DIRECTIONS[direction])
            client.camera.look_at = stage.center

    def _save(self, event: Any) -> None:
        from PIL import Image

        client = event.client
        if client is None:
            return
        camera = client.camera
        pixels = client.get_render(camera.image_height, camera.image_width, transport_format="png", timeout=30.0)
        file = io.BytesIO()
        Image.fromarray(pixels[..., :3]).save(file, "PNG")
        name = f"{self._viewer.source.title}.png".replace("/", "-")
        client.send_file_download(name, file.getvalue(), save_immediately=True)
