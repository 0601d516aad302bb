"""Cameras in a simulated world: pictures, depth in metres, and what stands in the way."""

import logging
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

import manyhands.pybullet as p
from manyhands.manipulapy import sim
from manyhands.manipulapy.sim.sliders import Sliders
from manyhands.manipulapy.stereo import Stereo
from manyhands.manipulapy.utils import euler_to_rotation_matrix

OPENCV_AVAILABLE = find_spec("cv2") is not None
ULTRALYTICS_AVAILABLE = find_spec("ultralytics") is not None

_WIDTH, _HEIGHT = 640, 480
_LOOK_AT = np.array([0.0, 0.0, 0.5])  # of a camera that is given no rotation
_SLIDERS = {
    "target_x": (-1.0, 1.0, 0.0),
    "target_y": (-1.0, 1.0, 0.0),
    "target_z": (-1.0, 1.0, 0.0),
    "distance": (0.0, 10.0, 2.0),
    "yaw": (-180.0, 180.0, 0.0),
    "pitch": (-180.0, 180.0, -40.0),
    "roll": (-180.0, 180.0, 0.0),
    "upAxisIndex": (0.0, 2.0, 2.0),
    "width": (100.0, 1000.0, 320.0),
    "height": (100.0, 1000.0, 240.0),
    "fov": (1.0, 180.0, 60.0),
    "near_val": (1e-3, 1.0, 0.1),
    "far_val": (1.0, 50.0, 5.0),
}

__all__ = ["OPENCV_AVAILABLE", "ULTRALYTICS_AVAILABLE", "Vision", "clear_yolo_cache", "detect_objects"]


class Vision(Stereo):
    """Cameras of a client, by default of the newest `Simulation` that is open, else client 0.

    camera_configs: dictionaries of name, translation (3,) [m], rotation (roll, pitch, yaw) [degrees], fov [degrees, up
    and down], near, far [m], intrinsic_matrix (3, 3), distortion_coeffs. A camera looks along its z axis, x to the
    right and y down; one without a rotation looks at (0, 0, 0.5). Without any there is one at (2, 0, 1).
    stereo_configs: two more, left and right, for pictures that the program has; see `Stereo`.
    use_pybullet_debug: the first camera goes where sliders say.
    """

    def __init__(
        self,
        camera_configs: Sequence[dict[str, Any]] | None = None,
        stereo_configs: Any = None,
        use_pybullet_debug: bool = False,
        show_plot: bool = True,
        logger_name: str = "VisionSystemLogger",
        physics_client: int | None = None,
    ) -> None:
        del show_plot
        self.logger, self.yolo_model = logging.getLogger(logger_name), None
        self.physics_client = sim.newest_client() if physics_client is None else physics_client
        self.use_pybullet_debug = use_pybullet_debug
        super().__init__(stereo_configs)
        given = camera_configs if camera_configs is not None else [{"name": "camera", "translation": [2.0, 0.0, 1.0]}]
        self.cameras = {k: _camera(config) for k, config in enumerate(given)}
        self._last: dict[int, dict[str, Any]] = {}
        self.sliders: Sliders | None = None
        self.slider_ids: dict[str, int] = {}
        if use_pybullet_debug:
            self.sliders = Sliders(self.physics_client)
            self.slider_ids = {name: self.sliders.add(name, *span) for name, span in _SLIDERS.items()}
            self.cameras.setdefault(0, _camera({"name": "debug"}))

    def read_debug_parameters(self) -> dict[str, float]:
        """The values of the sliders by name."""
        if self.sliders is None:
            raise RuntimeError("there are no sliders; make the Vision with use_pybullet_debug=True")
        return {name: self.sliders.read(number) for name, number in self.slider_ids.items()}

    def set_parameter(self, name: str, value: float) -> None:
        """Moves a slider, as people do."""
        if self.sliders is None or name not in self.slider_ids:
            raise ValueError(f"there is no slider {name!r}; there are {', '.join(self.slider_ids)}")
        self.sliders.set(self.slider_ids[name], value)

    # ---- pictures ----------------------------------------------------------------------------------------------

    def capture_image(self, camera_index: int = 0) -> tuple[Any, Any]:
        """Colours (height, width, 3) and depth along the camera's axis (height, width) float32 [m]; (None, None) of a
        camera that is not there."""
        if camera_index not in self.cameras:
            self.logger.error("there is no camera %r; there are %s", camera_index, list(self.cameras))
            return None, None
        try:
            found = self._last[camera_index] = self._capture(camera_index)
        except p.error as reason:
            self.logger.error("camera %r sees nothing: %s", camera_index, reason)
            return None, None
        return found["rgb"], found["depth"]

    def _capture(self, camera_index: int) -> dict[str, Any]:
        view, fov, near, far, width, height = self._view(camera_index)
        projection = p.computeProjectionMatrixFOV(fov, width / height, near, far)
        _, _, rgba, buffer, bodies = p.getCameraImage(
            width, height, view, projection, physicsClientId=self.physics_client
        )
        depth = far * near / (far - (far - near) * np.asarray(buffer, np.float64).reshape(height, width))
        return {
            "rgb": np.asarray(rgba, np.uint8).reshape(height, width, 4)[..., :3].copy(),
            "depth": depth.astype(np.float32),
            "bodies": np.asarray(bodies).reshape(height, width),
            "focus": 0.5 * height / np.tan(np.radians(fov) / 2),
            "X_WC": _pose_of(view),
        }

    def _view(self, camera_index: int) -> tuple[Any, float, float, float, int, int]:
        if self.use_pybullet_debug and camera_index == 0:
            s = self.read_debug_parameters()
            view = p.computeViewMatrixFromYawPitchRoll(
                [s["target_x"], s["target_y"], s["target_z"]],
                max(s["distance"], 1e-3),
                s["yaw"],
                s["pitch"],
                s["roll"],
                round(s["upAxisIndex"]),
            )
            return view, s["fov"], s["near_val"], s["far_val"], int(s["width"]), int(s["height"])
        camera = self.cameras[camera_index]
        X = camera["extrinsic_matrix"]
        eye = X[:3, 3]
        view = p.computeViewMatrix(eye.tolist(), (eye + X[:3, 2]).tolist(), (-X[:3, 1]).tolist())
        return view, camera["fov"], camera["near"], camera["far"], _WIDTH, _HEIGHT

    # ---- obstacles ---------------------------------------------------------------------------------------------

    def detect_obstacles(
        self,
        depth_image: ArrayLike | None,
        rgb_image: ArrayLike | None,
        depth_threshold: float = 5.0,
        camera_index: int = 0,
        step: int = 5,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Points (N, 3) in the world [m] of every step-th pixel of every step-th row that shows an obstacle nearer than
        depth_threshold [m]: a body that is neither floor nor robot, and that can be touched. And the direction in which
        each lies about z from the camera (N,) [degrees]. The picture is that of the last capture_image; others
        give none."""
        none = np.zeros((0, 3), np.float32), np.zeros(0, np.float32)
        found, depth = self._last.get(camera_index), np.asarray([] if depth_image is None else depth_image)
        if found is None or rgb_image is None or depth.squeeze().shape != found["depth"].shape:
            return none
        depth = depth.reshape(found["depth"].shape).astype(np.float64)
        height, width = depth.shape
        rows, columns = np.mgrid[0:height:step, 0:width:step]
        near = depth[rows, columns]
        wanted = np.isin(found["bodies"][rows, columns], self._obstacles()) & (near > 0) & (near < depth_threshold)
        x = (columns[wanted] + 0.5 - width / 2) / found["focus"]
        y = (rows[wanted] + 0.5 - height / 2) / found["focus"]
        seen = np.stack([x, y, np.ones_like(x)], axis=1) * near[wanted][:, None]
        way = seen @ found["X_WC"][:3, :3].T
        points = way + found["X_WC"][:3, 3]
        return points.astype(np.float32), np.degrees(np.arctan2(way[:, 1], way[:, 0])).astype(np.float32)

    def _obstacles(self) -> list[int]:
        """Bodies with a shape that collides: no floor, and no arm that stands fixed."""
        client, found = self.physics_client, []
        for k in range(p.getNumBodies(physicsClientId=client)):
            body = p.getBodyUniqueId(k, physicsClientId=client)
            if body in sim.scenery(client):
                continue
            joints = range(p.getNumJoints(body, physicsClientId=client))
            shapes = [
                shape for link in (-1, *joints) for shape in p.getCollisionShapeData(body, link, physicsClientId=client)
            ]
            moves = any(p.getJointInfo(body, j, physicsClientId=client)[2] != p.JOINT_FIXED for j in joints)
            stands = p.getDynamicsInfo(body, -1, physicsClientId=client)[0] == 0
            if shapes and not any(shape[2] == p.GEOM_PLANE for shape in shapes) and not (moves and stands):
                found.append(body)
        return found

    def release(self) -> None:
        """Lets the cameras go: rendered ones hold nothing."""


def detect_objects(image: ArrayLike, model_path: str | None = None) -> NoReturn:
    """Raises ImportError: networks that detect objects are not part of this package."""
    del image, model_path
    raise ImportError("detection by YOLO is not here; Vision.detect_obstacles sees what is rendered")


def clear_yolo_cache() -> None:
    """There is none."""


def _camera(config: dict[str, Any]) -> dict[str, Any]:
    """A camera with what its dictionary leaves out."""
    if config.get("use_opencv"):
        raise RuntimeError("cameras of this machine are not read here; cameras of the simulated world are")
    translation = np.asarray(config.get("translation", [0.0, 0.0, 0.0]), np.float64)
    X = np.eye(4)
    X[:3, 3] = translation
    rotation = config.get("rotation")
    X[:3, :3] = _towards(_LOOK_AT - translation) if rotation is None else euler_to_rotation_matrix(rotation)
    fov = float(config.get("fov", 60.0))
    focus = 0.5 * _HEIGHT / np.tan(np.radians(fov) / 2)
    K = np.array([[focus, 0, _WIDTH / 2], [0, focus, _HEIGHT / 2], [0, 0, 1]])
    return {
        "name": "camera",
        "near": 0.1,
        "far": 5.0,
        "distortion_coeffs": np.zeros(5),
        "intrinsic_matrix": K,
        **config,
        "fov": fov,
        "translation": translation,
        "extrinsic_matrix": X,
    }


def _towards(way: NDArray[np.float64]) -> NDArray[np.float64]:
    """Axes of a camera that looks along a way, the world's z up in its picture."""
    z = way / max(float(np.linalg.norm(way)), 1e-9)
    up = np.array([0.0, 0.0, 1.0]) if abs(z[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    x = np.cross(z, up)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def _pose_of(view: Sequence[float]) -> NDArray[np.float64]:
    """Of a view matrix by columns: the camera's pose, z ahead and y down."""
    V = np.asarray(view, np.float64).reshape(4, 4).T
    X = np.eye(4)
    X[:3, :3] = V[:3, :3].T @ np.diag([1.0, -1.0, -1.0])
    X[:3, 3] = -V[:3, :3].T @ V[:3, 3]
    return X
