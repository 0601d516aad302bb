"""Highlights of specular colours, which pictures of the world do not have."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from manyhands._core.render import Camera, Look, Picture
from manyhands.rotations import Array, rotate

_SHARPNESS = 64.0  # as the exponent of Blinn's and Phong's law


def add_highlights(
    picture: Picture, camera: Camera, look: Look, specular: Mapping[int, Sequence[float]]
) -> NDArray[np.uint8]:
    """The colours (height, width, 3) of a picture, and on them the sun's highlights on links of these indices and
    specular colours (3), 0 to 1. It has segmentation and normals. Shadows do not take highlights away."""
    colour = picture.colour.astype(np.float32)
    light = _unit(look.light)
    for link, shade in specular.items():
        rows, columns = np.nonzero(picture.segmentation == link)
        normals = picture.normals[rows, columns].astype(np.float64)
        x, y = (columns + 0.5 - camera.cx) / camera.fx, (rows + 0.5 - camera.cy) / camera.fy
        rays = np.stack([x, y, np.ones_like(x)], axis=-1)
        to_eye = -_unit(rays @ _matrix(camera.quaternion).T)
        aligned = np.sum(normals * _unit(to_eye + light), axis=-1)
        strength = np.where(normals @ light > 0, np.clip(aligned, 0, 1) ** _SHARPNESS, 0) * look.sun
        colour[rows, columns] += 255 * strength[:, None] * np.asarray(shade)
    return np.clip(np.rint(colour), 0, 255).astype(np.uint8)


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _matrix(quaternion: Array) -> Array:
    return np.stack([rotate(quaternion, axis) for axis in np.eye(3)], axis=-1)
