"""Stereo of a `Vision`: two cameras, by `manyhands.vision`."""

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.manipulapy.utils import euler_to_rotation_matrix
from manyhands.vision import Lens, StereoRig

__all__ = ["Stereo"]

_KEYS = ("intrinsic_matrix", "distortion_coeffs", "translation", "rotation")
_DISPARITIES, _BLOCK = 64, 7
_FARTHEST = 10.0  # of points [m]


class Stereo:
    """Two cameras: dictionaries of intrinsic_matrix (3, 3), where the first pixel's centre is 0, distortion_coeffs,
    translation (3,) [m], rotation (roll, pitch, yaw) [degrees]; a camera looks along its z axis, x to the right."""

    logger: logging.Logger

    def __init__(self, configs: Sequence[dict[str, Any]] | None) -> None:
        self.stereo_enabled = configs is not None
        self.left_cam_cfg, self.right_cam_cfg = configs or (None, None)
        for config in configs or ():
            for key in _KEYS:
                if key not in config:
                    raise ValueError(f"a stereo camera has no {key!r}")
        self._rig: StereoRig | None = None
        self.left_map_x: Any = None
        self.left_map_y: Any = None
        self.right_map_x: Any = None
        self.right_map_y: Any = None
        self.Q: Any = None

    def compute_stereo_rectification_maps(self, image_size: tuple[int, int] = (640, 480)) -> None:
        """Makes `left_map_x` and its kin and `Q`, for pictures of image_size. Without stereo a warning is all."""
        if self.left_cam_cfg is None or self.right_cam_cfg is None:
            self.logger.warning("stereo is off: give Vision stereo_configs")
            return
        lenses = [_lens(config, image_size) for config in (self.left_cam_cfg, self.right_cam_cfg)]
        self._rig = StereoRig(*lenses, disparities=_DISPARITIES, block=_BLOCK)
        (self.left_map_x, self.left_map_y), (self.right_map_x, self.right_map_y) = self._rig.maps
        self.Q = self._rig.Q

    def rectify_stereo_images(self, left_img: ArrayLike, right_img: ArrayLike) -> tuple[Any, Any]:
        """Both pictures turned so that a point has the same row in them. Raises RuntimeError without maps."""
        return self._ready().rectify(left_img, right_img)

    def compute_disparity(self, left_rectified: ArrayLike, right_rectified: ArrayLike) -> NDArray[np.float32]:
        """Of rectified pictures [pixels], NaN where nothing fits. Raises RuntimeError without maps."""
        return self._ready().disparity(left_rectified, right_rectified)

    def disparity_to_pointcloud(self, disparity: ArrayLike) -> NDArray[np.float32]:
        """Points (N, 3) in the rectified left camera's frame [m], nearer than 10 m. Raises RuntimeError if there are
        no maps."""
        rig, given = self._ready(), np.asarray(disparity, np.float32)
        X = np.linalg.inv(rig.X_rectified)
        wanted = np.isfinite(given) & (given > 0)
        points = rig.points(given)[wanted] @ X[:3, :3].T + X[:3, 3]
        return points[points[:, 2] < _FARTHEST].astype(np.float32)

    def get_stereo_point_cloud(self, left_img: ArrayLike, right_img: ArrayLike) -> NDArray[np.float32]:
        """All of it: maps, if there are none yet, rectified pictures, disparity, points (N, 3)."""
        if self._rig is None and self.stereo_enabled:
            height, width = np.shape(left_img)[:2]
            self.compute_stereo_rectification_maps((width, height))
        return self.disparity_to_pointcloud(self.compute_disparity(*self.rectify_stereo_images(left_img, right_img)))

    def _ready(self) -> StereoRig:
        if not self.stereo_enabled:
            raise RuntimeError("stereo is off: give Vision stereo_configs")
        if self._rig is None:
            raise RuntimeError("there are no maps yet: call compute_stereo_rectification_maps")
        return self._rig


def _lens(config: dict[str, Any], size: tuple[int, int]) -> Lens:
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = euler_to_rotation_matrix(config["rotation"]), config["translation"]
    matrix, distortion = (np.asarray(config[key], np.float64) for key in ("intrinsic_matrix", "distortion_coeffs"))
    return Lens.of_opencv((int(size[0]), int(size[1])), matrix, X, distortion.ravel())
