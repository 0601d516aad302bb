"""A page of the viewer's in a real browser, without a display or a GPU."""

from pathlib import Path
from typing import Any

import numpy as np
import viewed
from PIL import Image

from manyhands.measures import rotate
from manyhands.viewer import Viewer

SIZE = {"width": 860, "height": 480}  # 470 of it for the scene
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def show(page: Any, viewer: Viewer) -> None:
    """Opens a viewer's page, without shadows: software draws them slowly."""
    viewer.stage.shadows = False
    if not page.url.startswith(viewer.url.partition("?")[0]):
        page.goto(viewer.url)
        # What browsers say of WebGL in software would cover the scene.
        page.add_style_tag(content=".mantine-Notifications-root { display: none }")
        until(lambda: viewer.server.get_clients())


def until(condition: Any, seconds: float = 60.0) -> None:
    """Waits until a callable is true; software draws slowly."""
    viewed.until(condition, seconds)


def pixels(page: Any, path: Path, width: int = 470) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """The part of the page where the scene is."""
    page.screenshot(path=path)
    return np.asarray(Image.open(path).convert("RGB"))[:, :width]


def number_box(page: Any, label: str) -> Any:
    """The box with the number of a slider."""
    return row_of_slider(page, label).locator("input[type=text], input[inputmode]").last


def row_of_slider(page: Any, label: str) -> Any:
    return page.locator(f"xpath=//label[normalize-space()='{label}']/ancestor::*[.//input][1]")


def on_page(viewer: Viewer, page: Any, point: Any) -> tuple[float, float]:
    """Where a place in the world (3) is seen on the page [pixels]."""
    (client,) = viewer.server.get_clients().values()
    camera, box = client.camera, page.locator("canvas").first.bounding_box()
    w, x, y, z = camera.wxyz
    turned = rotate(np.array([-x, -y, -z, w]), np.asarray(point) - camera.position)
    scale = box["height"] / 2 / np.tan(camera.fov / 2)
    return (
        box["x"] + box["width"] / 2 + scale * turned[0] / turned[2],
        box["y"] + box["height"] / 2 + scale * turned[1] / turned[2],
    )
