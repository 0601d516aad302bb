"""Obstacles that a camera sees, and groups of them."""

import logging

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands.manipulapy.vision import Vision
from manyhands.perception import dbscan

Array = NDArray[np.float32]

__all__ = ["Perception"]


class Perception:
    """On a `Vision`. Raises ValueError without one."""

    def __init__(self, vision_instance: Vision | None = None, logger_name: str = "PerceptionLogger") -> None:
        if vision_instance is None:
            raise ValueError("a Perception needs a Vision: Perception(vision_instance=Vision(...))")
        self.vision, self.logger = vision_instance, logging.getLogger(logger_name)

    def detect_and_cluster_obstacles(
        self,
        camera_index: int = 0,
        depth_threshold: float = 5.0,
        step: int = 2,
        eps: float = 0.1,
        min_samples: int = 3,
    ) -> tuple[Array, NDArray[np.int32]]:
        """Points (N, 3) of obstacles in the world [m], one of step² pixels, and their clusters (N,), -1 of noise.
        Floors and robots are no obstacles. Without any both are empty."""
        none = np.zeros((0, 3), np.float32), np.zeros(0, np.int32)
        rgb, depth = self.vision.capture_image(camera_index=camera_index)
        if depth is None or rgb is None:
            return none
        points, _ = self.vision.detect_obstacles(
            depth, rgb, depth_threshold=depth_threshold, camera_index=camera_index, step=step
        )
        if points is None or len(points) == 0:  # a `Vision` of the program's own may answer None
            self.logger.info("camera %d sees no obstacle", camera_index)
            return none
        labels, _ = self.cluster_obstacles(points, eps, min_samples)
        return points, labels

    def cluster_obstacles(
        self, points: ArrayLike, eps: float = 0.1, min_samples: int = 3
    ) -> tuple[NDArray[np.int32], int]:
        """The cluster (N,) of every point, -1 of noise, and how many clusters there are."""
        cloud = np.asarray(points, np.float64)
        if cloud.size == 0:
            return np.zeros(0, np.int32), 0
        labels = dbscan(cloud, eps, min_samples)
        return labels, int(labels.max(initial=-1)) + 1

    def compute_stereo_disparity(self, left_img: ArrayLike, right_img: ArrayLike) -> Array:
        """Of two pictures; see `Vision.compute_disparity`."""
        if not self.vision.stereo_enabled:
            raise RuntimeError("stereo is off: give Vision stereo_configs")
        left, right = self.vision.rectify_stereo_images(left_img, right_img)
        return self.vision.compute_disparity(left, right)

    def get_stereo_point_cloud(self, left_img: ArrayLike, right_img: ArrayLike) -> Array:
        """Of two pictures; empty where stereo is off."""
        if not self.vision.stereo_enabled:
            self.logger.error("stereo is off: give Vision stereo_configs")
            return np.zeros((0, 3), np.float32)
        return self.vision.get_stereo_point_cloud(left_img, right_img)

    def release(self) -> None:
        """Lets the cameras go."""
        self.vision.release()
