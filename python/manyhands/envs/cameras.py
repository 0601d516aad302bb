"""What environments show: the pictures of `render`, and those of cameras in the observation."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from manyhands._core.envs import EnvBatch, EnvBodies, EnvPictures, Eye, PictureVariation
from manyhands._core.render import Camera, Look
from manyhands.arguments import whole_number
from manyhands.envs.parts import hand_of
from manyhands.envs.spaces import CameraOptions, EnvOptions
from manyhands.refusals import signatures_of

RENDER_MODES = ("rgb_array", "depth_array")
FINE: dict[str, Any] = {"antialiasing": 2, "shadow_rays": 6, "sun_size": 0.05}
"""The look of pictures for people, as arguments of `Look`."""
_FINE_LOOK = Look(**FINE)
_FEW = 64  # worlds that fit in a tiled picture
_ROWS = ("observation", "achieved_goal", "desired_goal")
_PLACES: dict[str, CameraOptions] = {
    "front": {"eye": (0.75, -0.55, 0.5), "target": (-0.12, 0.0, 0.1), "fov_y": 0.75},
    "top": {"eye": (0.0, 0.0, 1.1), "target": (0.0, 0.0, 0.0), "up": (1.0, 0.0, 0.0), "fov_y": 0.6},
    "wrist": {"eye": (0.07, 0.0, -0.1), "target": (0.03, 0.0, 0.1), "up": (1.0, 0.0, 0.0), "fov_y": 1.2},  # of the hand
}


def require_mode(render_mode: str | None, modes: Sequence[str] = RENDER_MODES) -> None:
    """Raises ValueError on a mode that is not known."""
    if render_mode is not None and render_mode not in modes:
        raise ValueError(f"render_mode is {render_mode!r}, expected None or one of {tuple(modes)}")


def orbit_camera(
    width: int, height: int, target: Any, distance: float, yaw: float, pitch: float, roll: float
) -> Camera:
    """panda-gym's camera: 60 degrees from top to bottom; angles in degrees. Raises ValueError on other numbers."""
    width, height = (whole_number("render size", size, 1, 16384) for size in (width, height))
    point = np.zeros(3) if target is None else np.asarray(target, np.float64).reshape(3)
    camera = Camera.perspective(width, height, math.radians(60)).clipped(0.1, 100)
    return camera.orbit(point.tolist(), distance, *(math.radians(angle) for angle in (yaw, pitch, roll)))


class EnvCameras:
    """The cameras of a batch: that of `render`, and those that are observed. Nothing is loaded before it is needed."""

    def __init__(self, batch: EnvBatch, render_mode: str | None, options: EnvOptions, num_threads: int) -> None:
        """Raises ValueError on an unknown mode, or a camera that cannot be, KeyError on one in a frame that is not."""
        require_mode(render_mode)
        self._batch, self._threads, self._mode = batch, num_threads, render_mode
        self._pictures: EnvPictures | None = None
        self.final: dict[str, NDArray[Any]] = {}
        """The pictures that `keep_final` took last."""
        self._size = options.get("render_width", 720), options.get("render_height", 480)
        self._orbit = (
            options.get("render_target_position"),
            options.get("render_distance", 1.4),
            options.get("render_yaw", 45),
            options.get("render_pitch", -30),
            options.get("render_roll", 0),
        )
        self._camera = orbit_camera(*self._size, *self._orbit)
        self._floor = _colour("render_floor", options.get("render_floor"))
        self._observed = {
            name: _observed(name, given, options) for name, given in (options.get("cameras") or {}).items()
        }
        _require_frames(batch, {name: camera.frame for name, (camera, _) in self._observed.items()})

    def spaces(self) -> dict[str, spaces.Space[Any]]:
        """Of one world's pictures, by their names in the observation."""
        found: dict[str, spaces.Space[Any]] = {}
        for name, (camera, options) in self._observed.items():
            size = camera.height, camera.width
            found[name] = spaces.Box(0, 255, (*size, 3), np.uint8)
            if options.get("depth"):
                found[f"{name}_depth"] = spaces.Box(0.0, camera.far, size, np.float32)
            if options.get("segmentation"):
                found[f"{name}_segmentation"] = spaces.Box(-1, 2**31 - 1, size, np.int32)
        return found

    def observe(self, worlds: Sequence[int] | None = None) -> dict[str, NDArray[Any]]:
        """Pictures of all worlds, or of some: (n, height, width, 3), depth and segmentation (n, height, width)."""
        seen: dict[str, NDArray[Any]] = {}
        for number, (name, (camera, options)) in enumerate(self._observed.items()):
            depth, segmentation = options.get("depth", False), options.get("segmentation", False)
            picture = self._load().take(
                camera,
                worlds=worlds,
                look=options.get("look", Look()),
                variation=_variation(name, options),
                camera_number=number,
                depth=depth,
                segmentation=segmentation,
            )
            seen[name] = picture.colour
            if depth:
                seen[f"{name}_depth"] = picture.depth
            if segmentation:
                seen[f"{name}_segmentation"] = picture.segmentation
        return seen

    def render(self) -> NDArray[Any] | None:
        """The picture of the render mode: of one world, or of up to 64 in tiles. None without a mode."""
        n = min(self._batch.num_envs, _FEW)
        columns = math.ceil(math.sqrt(n))
        rows = math.ceil(n / columns)
        frames = self.frames(range(n), max(self._size[0] // columns, 1), max(self._size[1] // rows, 1))
        if frames is None or n == 1:
            return None if frames is None else frames[0]
        blank = np.zeros((columns * rows - n, *frames.shape[1:]), frames.dtype)
        tiles = np.concatenate([frames, blank]).reshape(rows, columns, *frames.shape[1:])
        height, width = frames.shape[1:3]
        return tiles.swapaxes(1, 2).reshape(rows * height, columns * width, *frames.shape[3:])

    def frames(self, worlds: Sequence[int], width: int | None = None, height: int | None = None) -> NDArray[Any] | None:
        """What `render` shows of each world: (n, height, width, 3) colours, or (n, height, width) depths [m]."""
        if self._mode is None:
            return None
        size = width or self._size[0], height or self._size[1]
        camera = self._camera if size == self._size else orbit_camera(*size, *self._orbit)
        is_depth = self._mode == "depth_array"
        picture = self._load().take(
            camera,
            worlds=list(worlds),
            look=_FINE_LOOK,
            colour=not is_depth,
            depth=is_depth,
            floor=self._floor,
        )
        return picture.depth if is_depth else picture.colour

    def keep_final(self, worlds: list[int]) -> None:
        """Takes the last pictures of episodes that end, before their worlds start anew."""
        self.final = self.observe(worlds)

    def _load(self) -> EnvPictures:
        if self._pictures is None:
            self._pictures = EnvPictures(self._batch, self._threads)
        return self._pictures


def eyes(batch: EnvBatch, cameras: Mapping[str, CameraOptions | Camera]) -> list[Eye]:
    """The same cameras as a trainer takes them. Raises ValueError if one cannot be, KeyError on one in a frame that is
    not."""
    observed = {name: _observed(name, given, {}) for name, given in cameras.items()}
    _require_frames(batch, {name: camera.frame for name, (camera, _) in observed.items()})
    return [
        Eye(camera, options.get("look", Look()), _variation(name, options))
        for name, (camera, options) in observed.items()
    ]


def picture_bytes(cameras: Mapping[str, CameraOptions | Camera]) -> int:
    """What one picture of each takes: 3 bytes a pixel."""
    taken = (_observed(name, given, {})[0] for name, given in cameras.items())
    return sum(3 * camera.width * camera.height for camera in taken)


def _observed(name: str, given: CameraOptions | Camera, env: EnvOptions) -> tuple[Camera, CameraOptions]:
    """A camera of the observation and its options. Raises ValueError if it cannot be made."""
    if name in _ROWS:
        raise ValueError(f"cameras: {name!r} is in the observation already; choose another name")
    if isinstance(given, Camera):
        return given, {}
    if not isinstance(given, Mapping):
        raise ValueError(f"cameras: {name!r} is {given!r}, expected a dict of options or a manyhands.Camera")
    if unknown := set(given) - set(CameraOptions.__annotations__):
        raise ValueError(
            f"cameras: {name!r} has {sorted(unknown)}; options are {sorted(CameraOptions.__annotations__)}"
        )
    place = dict(_PLACES.get(name, {}))
    if name == "wrist":
        place["frame"] = hand_of(env.get("robot"))
    options = cast(CameraOptions, {**place, **given})
    if "eye" not in options or "target" not in options:
        raise ValueError(
            f"cameras: {name!r} needs an eye and a target; only {sorted(_PLACES)} have places of their own"
        )
    camera = Camera.perspective(options.get("width", 84), options.get("height", 84), options.get("fov_y", 0.8))
    _variation(name, options)
    points = options["eye"], options["target"], options.get("up", (0, 0, 1))
    eye, target, up = (np.asarray(point, np.float64).tolist() for point in points)
    return camera.look_at(eye, target, up, options.get("frame", "")), options


def _colour(name: str, given: ArrayLike | None) -> list[float] | None:
    """Red, green and blue. Raises ValueError unless each is from 0 to 1."""
    if given is None:
        return None
    colour = np.asarray(given, np.float64)
    if not ((colour >= 0) & (colour <= 1)).all():
        raise ValueError(f"{name} is {given}, expected red, green and blue, each from 0 to 1")
    return colour.tolist()


def _require_frames(batch: EnvBatch, frames: Mapping[str, str]) -> None:
    """Raises KeyError unless what cameras are mounted on, by their names, is there."""
    if not any(frames.values()):
        return
    model = EnvBodies(batch).model
    known = dict.fromkeys(each.name for each in (*model.links, *model.frames))
    for name, frame in frames.items():
        if frame and frame not in known:
            raise KeyError(f"cameras: {name!r}: there is no frame or link {frame!r}; there are {', '.join(known)}")


def _variation(name: str, options: CameraOptions) -> PictureVariation:
    """What varies of a camera's pictures. Raises ValueError on unknown names and numbers out of range."""
    try:
        return PictureVariation(**options.get("vary", {}))
    except TypeError as reason:
        (signature,) = signatures_of(PictureVariation.__init__)
        known = [parameter for parameter in signature.parameters if parameter != "self"]
        raise ValueError(
            f"cameras: {name!r} varies {options.get('vary')!r}; what can vary is {', '.join(known)}"
        ) from reason
