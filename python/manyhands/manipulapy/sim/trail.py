"""The way of an end effector, drawn as geometry that cameras see and bodies do not touch."""

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

import manyhands.pybullet

p: Any = manyhands.pybullet  # its stubs take the types of defaults for those of arguments

Array = NDArray[np.float64]

_SHORTEST = 1e-6  # [m]
_ASIDE = np.array([0.002, 0.0, 0.0])  # from the end effector [m]


def draw_trail(client: int, places: Array, line_width: float, color: list[float]) -> tuple[list[int], list[int]]:
    """Capsules along places (N, 3), of a radius of a millimetre for each of line_width, and balls over its begin
    (green), its end (red) and, of more than ten places, its quarters (blue). The ids of both kinds of bodies."""
    rgba = [*color, 1.0][:4] if len(color) == 3 else color
    segments = [
        _body(
            client,
            p.GEOM_CAPSULE,
            rgba,
            (a + b) / 2 + _ASIDE,
            _along(b - a),
            0.001 * line_width,
            float(np.linalg.norm(b - a)),
        )
        for a, b in itertools.pairwise(places)
        if np.linalg.norm(b - a) > _SHORTEST
    ]
    n, level = len(places), [0.0, 0.0, 0.0, 1.0]
    marks = [([0.0, 1.0, 0.0, 1.0], 0.02, 0.05, 0), ([1.0, 0.0, 0.0, 1.0], 0.02, 0.05, n - 1)]
    if n > 10:
        marks += [([0.0, 0.0, 1.0, 1.0], 0.015, 0.03, k) for k in (n // 4, n // 2, 3 * n // 4)]
    balls = [
        _body(client, p.GEOM_SPHERE, colour, places[k] + [0, 0, above], level, radius)
        for colour, radius, above, k in marks
    ]
    return segments, balls


def _along(direction: Array) -> list[float]:
    """The quaternion of the shortest turn from z to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -1 + 1e-12:
        return [1.0, 0.0, 0.0, 0.0]
    q = np.array([-y, x, 0.0, 1 + z])
    return (q / np.linalg.norm(q)).tolist()


def _body(
    client: int,
    shape: int,
    rgba: list[float],
    position: Array,
    orientation: list[float],
    radius: float,
    length: float = 1,
) -> int:
    looks = p.createVisualShape(shape, radius=radius, length=length, rgbaColor=rgba, physicsClientId=client)
    return p.createMultiBody(
        baseMass=0,
        baseVisualShapeIndex=looks,
        basePosition=position.tolist(),
        baseOrientation=orientation,
        physicsClientId=client,
    )
