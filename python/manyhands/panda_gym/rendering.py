"""What a simulation shows: pictures, and a page in the browser."""

import time
import warnings
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import World
from manyhands._core.render import Camera, Look, Mark
from manyhands.envs.cameras import FINE
from manyhands.envs.page import Page
from manyhands.panda_gym.assets import get_data_path
from manyhands.panda_gym.bodies import Body
from manyhands.panda_gym.highlights import add_highlights
from manyhands.textures import load_texture

MODES = ("human", "rgb_array")
RENDERERS = ("Tiny", "OpenGL")


def require_mode(mode: str, renderer: str) -> None:
    """Raises ValueError on an unknown mode, or a renderer that is unknown where one is needed."""
    if mode not in MODES:
        raise ValueError(f"render_mode is {mode!r}, expected one of {MODES}")
    if mode == "rgb_array" and renderer not in RENDERERS:
        raise ValueError(f"renderer is {renderer!r}, expected one of {RENDERERS}")


class Display:
    """A page in the browser that shows a simulation in real time; without the extra `viewer`, it only keeps time."""

    def __init__(self) -> None:
        self._page = Page()
        self._has_page = True
        self._start: tuple[float, float] | None = None  # on the clock, in simulated time

    def show(self, sim: Any, simulated: float, real_time: bool) -> None:
        """After each step: waits until the wall clock has caught up with `simulated` [s], and while the page is paused.
        Who comes late is not hurried afterwards."""
        if self._has_page:
            try:
                self._page.show(sim, real_time=real_time)
                return
            except ModuleNotFoundError as reason:
                self._has_page = False
                warnings.warn(f"human rendering only keeps real time: {reason}", UserWarning, 3)
        if real_time:
            self._wait(simulated)

    def look(self, target: ArrayLike, distance: float, yaw: float, pitch: float) -> None:
        """Turns the page's camera as PyBullet's: angles in degrees."""
        turn, rise = np.radians(yaw), np.radians(pitch)
        ahead = np.array([-np.sin(turn) * np.cos(rise), np.cos(turn) * np.cos(rise), np.sin(rise)])
        look_at = np.asarray(target, np.float64)
        self._page.look(look_at - distance * ahead, look_at)

    def close(self) -> None:
        """Takes the page away."""
        self._page.close()

    def _wait(self, simulated: float) -> None:
        now = time.perf_counter()
        if self._start is None or simulated < self._start[1]:
            self._start = now, simulated
            return
        due = self._start[0] + simulated - self._start[1]
        if due > now:
            time.sleep(due - now)
        else:
            self._start = now, simulated


def picture(
    world: World, bodies: Iterable[Body], camera: Camera, background: ArrayLike | None = None
) -> NDArray[np.uint8]:
    """What the camera sees of the world, (height, width, 3), and over it the ghosts, which are not in it.

    background (3): a colour, 0 to 1, in place of the sky.
    """
    shapes = [body for body in bodies if body.shape is not None]
    dice = [body.links[0] for body in shapes if body.in_world and _is_die(body)]
    textures = {
        body.links[0]: _texture(body.look.texture)
        for body in shapes
        if body.in_world and body.look.texture is not None and not _is_die(body)
    }
    marks = [_mark(body) for body in shapes if not body.in_world and body.look.rgba[3] > 0]
    behind: Any = {} if background is None else dict.fromkeys(("horizon", "zenith"), np.asarray(background).tolist())
    look = Look(**FINE, **behind)
    specular = {body.links[0]: body.look.specular for body in shapes if body.in_world and any(body.look.specular)}
    options: Any = {"look": look, "marks": marks, "dice": dice, "textures": textures}
    options |= {"depth": False, "segmentation": bool(specular), "normals": bool(specular)}
    taken = world.render(camera, **options)
    if not specular:
        return taken.colour
    colours = {i: specular[link.name] for i, link in enumerate(world.model.links) if link.name in specular}
    return add_highlights(taken, camera, look, colours)


_texture = lru_cache(16)(load_texture)


def _is_die(body: Body) -> bool:
    """Whether it wears the package's own picture, whose faces are drawn without it."""
    return body.look.texture is not None and body.look.texture.parent == Path(get_data_path())


def _mark(ghost: Body) -> Mark:
    assert ghost.shape is not None and ghost.pose is not None
    kind, sizes = ghost.shape
    rgba: Any = ghost.look.rgba
    position, quaternion = ghost.pose.position.tolist(), ghost.pose.quaternion.tolist()
    return Mark(kind, sizes, position, quaternion, rgba, is_die=_is_die(ghost))
