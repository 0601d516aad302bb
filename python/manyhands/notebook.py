"""What notebooks show of worlds, models and pictures: a picture, and the line that `print` gives."""

import math
import struct
import zlib
from base64 import b64encode
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Model, World
from manyhands._core.render import Camera, Look, Picture
from manyhands.rotations import rotate

SIZE = (480, 300)  # pixels
FIELD = math.radians(35)
MOST_GEOMS = 5000  # beyond, finding them takes longer than people wait for a cell


def png(colour: NDArray[np.uint8]) -> bytes:
    """A picture (height, width, 3) as a PNG file."""
    height, width, _ = colour.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), colour.reshape(height, 3 * width)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = zlib.compress(rows.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def picture_png(picture: Picture) -> bytes | None:
    """The colours of a picture, of several side by side up to eight; None if it has no colours."""
    colour = picture.colour
    if colour is None or colour.size == 0:
        return None
    return png(np.ascontiguousarray(colour if colour.ndim == 3 else np.concatenate(list(colour[:8]), axis=1)))


def extent(world: World) -> tuple[NDArray[np.float64], float]:
    """The middle of what is there, ground excepted, and how far it reaches [m]."""
    model = world.model
    points: list[NDArray[np.float64]] = []
    for geom in model.geoms[:MOST_GEOMS]:
        if geom.shape in ("plane", "height_field"):
            continue
        if geom.shape in ("mesh", "convex"):
            vertices = np.asarray(model.meshes[geom.mesh].vertices, np.float64)
            low, high = vertices.min(0), vertices.max(0)
            middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
        else:
            middle, radius = np.zeros(3), float(np.linalg.norm(geom.size))
        position, quaternion = world.body_pose(model.links[geom.link].name)
        centre = np.asarray(position) + rotate(quaternion, geom.position + rotate(geom.quaternion, middle))
        points += [centre - radius, centre + radius]
    if not points:
        return np.zeros(3), 1.0
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    return (low + high) / 2, max(float(np.linalg.norm(high - low)) / 2, 1e-3)


def portrait(world: World) -> Picture:
    """A picture with all of a world in it, seen from the front and above."""
    middle, reach = extent(world)
    camera = Camera.perspective(*SIZE, FIELD).orbit(
        list(middle), 0.9 * reach / math.tan(FIELD / 2) + 0.1 * reach, math.radians(40), math.radians(-22)
    )
    return world.render(camera, look=Look(antialiasing=2, shadow_rays=4), depth=False, segmentation=False)


def world_html(world: World) -> str:
    """A picture of a world, with its line."""
    data = picture_png(portrait(world))
    assert data is not None
    source = f"data:image/png;base64,{b64encode(data).decode()}"
    return f'<img src="{source}" alt="" width="{SIZE[0]}"><br><code>{escape(repr(world))}</code>'


def model_html(model: Model) -> str:
    """A picture of a model as worlds of it begin, with its line."""
    return world_html(World(model)).rsplit("<br>", 1)[0] + f"<br><code>{escape(repr(model))}</code>"


def show_in_notebooks() -> None:
    """Gives the compiled classes the methods that notebooks ask for."""
    for kind, name, method in (
        (World, "_repr_html_", world_html),
        (Model, "_repr_html_", model_html),
        (Picture, "_repr_png_", picture_png),
    ):
        wanted: Any = kind
        setattr(wanted, name, method)
