"""Mass, centre of mass and inertia of solids made of simple shapes. SI units."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robots.description import Box, Capsule, Cylinder, Placed, Shape, Sphere, Vec3
from robots.sdf import Array


def rotation(rpy: Vec3) -> Array:
    """Rotation matrix of URDF's roll, pitch and yaw."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _round_solid(shape: Cylinder) -> tuple[float, Array]:
    """Volume of a cylinder or capsule, and its central inertia at density 1."""
    r, h = shape.radius, shape.high - shape.low
    volume = math.pi * r * r * h
    along, across = volume * r * r / 2, volume * (3 * r * r + h * h) / 12
    if isinstance(shape, Capsule):
        ball = 4 / 3 * math.pi * r**3
        along += ball * 0.4 * r * r
        # Each half ball: 83/320 m r^2 about its own centre, which is 3/8 r beyond the end.
        across += ball * (83 / 320 * r * r + (h / 2 + 3 * r / 8) ** 2)
        volume += ball
    moments = np.full(3, across)
    moments["xyz".index(shape.axis)] = along
    return volume, np.diag(moments)


def _solid(shape: Shape) -> tuple[float, Array, Array]:
    """Volume, centre, and central inertia at density 1."""
    if isinstance(shape, Placed):
        volume, centre, tensor = _solid(shape.shape)
        turn = rotation(shape.rpy)
        return volume, np.array(shape.xyz) + turn @ centre, turn @ tensor @ turn.T
    if isinstance(shape, Box):
        size = np.subtract(shape.high, shape.low)
        volume = float(size[0] * size[1] * size[2])
        square = size**2
        return volume, np.add(shape.high, shape.low) / 2, np.diag(volume / 12 * (square.sum() - square))
    if isinstance(shape, Sphere):
        volume = 4 / 3 * math.pi * shape.radius**3
        return volume, np.array(shape.centre), np.eye(3) * (0.4 * volume * shape.radius**2)
    if isinstance(shape, Cylinder):
        volume, tensor = _round_solid(shape)
        centre = np.array(shape.centre)
        centre["xyz".index(shape.axis)] = (shape.low + shape.high) / 2
        return volume, centre, tensor
    raise TypeError(f"no inertia of {shape}")


def centre_of(shapes: list[Shape]) -> Vec3:
    """Centre of mass of a body of one density, overlaps counted twice; to 1 um."""
    solids = [_solid(shape) for shape in shapes]
    total = sum(volume for volume, _, _ in solids)
    x, y, z = (round(float(sum(v * c[i] for v, c, _ in solids) / total), 6) for i in range(3))
    return x, y, z


def inertia_of(mass: float, shapes: list[Shape], com: Vec3) -> Vec3:
    """Diagonal of the inertia about `com` of a body of one density, to four digits; its products are left out."""
    solids = [_solid(shape) for shape in shapes]
    total = np.zeros((3, 3))
    for volume, centre, tensor in solids:
        arm = centre - np.array(com)
        total += tensor + volume * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    scale = mass / sum(volume for volume, _, _ in solids)
    x, y, z = (float(f"{scale * total[i, i]:.4g}") for i in range(3))
    return x, y, z


def mass_properties(parts: Sequence[tuple[Shape, float]]) -> tuple[float, Vec3, Vec3, Vec3]:
    """Mass, centre of mass, and moments and products (xy, xz, yz) of inertia about it, of shapes and their densities.

    The mass to 0.1 g, the centre to 1 um, the inertia to four digits of its largest moment. Overlaps count twice.
    """
    solids = [
        (density * volume, centre, density * tensor)
        for shape, density in parts
        for volume, centre, tensor in [_solid(shape)]
    ]
    mass = sum(m for m, _, _ in solids)
    com = np.round(sum(m * c for m, c, _ in solids) / mass, 6) + 0.0
    total = np.zeros((3, 3))
    for m, centre, tensor in solids:
        arm = centre - com
        total += tensor + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    unit = 10.0 ** (math.floor(math.log10(float(total.max()))) - 3)
    ixx, iyy, izz, ixy, ixz, iyz = (
        float(f"{round(float(total[i, j]) / unit) * unit:.4g}")
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    )
    return round(mass, 4), (float(com[0]), float(com[1]), float(com[2])), (ixx, iyy, izz), (ixy, ixz, iyz)
