"""Signed distance fields of rounded solids, and their blending.

A field maps point coordinates (x, y, z), in metres, to a distance in metres, negative inside. Only + - * /, sqrt, abs,
min and max are used: IEEE 754 defines their results exactly, so the meshes do not depend on the machine's libm.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Field = Callable[[Array, Array, Array], Array]
Point = tuple[float, float, float]


def _rounded_corner(a: Array, b: Array, fillet: float) -> Array:
    """Distance to the region {a < 0 and b < 0} grown by `fillet`."""
    outside = np.sqrt(np.maximum(a, 0.0) ** 2 + np.maximum(b, 0.0) ** 2)
    return np.minimum(np.maximum(a, b), 0.0) + outside - fillet


def cylinder(
    axis: str, low: float, high: float, radius: float, fillet: float, centre: Point = (0.0, 0.0, 0.0)
) -> Field:
    """Cylinder along `axis` from `low` to `high` (absolute coordinates on that axis) with filleted rims."""
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    middle, half = 0.5 * (low + high), 0.5 * (high - low)

    def field(x: Array, y: Array, z: Array) -> Array:
        p = (x, y, z)
        radial = np.sqrt((p[j] - centre[j]) ** 2 + (p[k] - centre[k]) ** 2) - (radius - fillet)
        along = np.abs(p[i] - middle) - (half - fillet)
        return _rounded_corner(radial, along, fillet)

    return field


def box(low: Point, high: Point, fillet: float) -> Field:
    """Axis-aligned box between two corners with rounded edges."""

    def field(x: Array, y: Array, z: Array) -> Array:
        q = [np.abs(p - 0.5 * (a + b)) - (0.5 * (b - a) - fillet) for p, a, b in zip((x, y, z), low, high, strict=True)]
        inside = np.minimum(np.maximum(q[0], np.maximum(q[1], q[2])), 0.0)
        outside = np.sqrt(sum(np.maximum(c, 0.0) ** 2 for c in q))
        return inside + outside - fillet

    return field


def plate(low: Point, high: Point, corner: float, fillet: float) -> Field:
    """Flat box: vertical edges rounded by `corner`, top and bottom rims by `fillet`."""

    def field(x: Array, y: Array, z: Array) -> Array:
        u = np.abs(x - 0.5 * (low[0] + high[0])) - (0.5 * (high[0] - low[0]) - corner)
        v = np.abs(y - 0.5 * (low[1] + high[1])) - (0.5 * (high[1] - low[1]) - corner)
        outline = _rounded_corner(u, v, corner)
        along = np.abs(z - 0.5 * (low[2] + high[2])) - (0.5 * (high[2] - low[2]) - fillet)
        return _rounded_corner(outline + fillet, along, fillet)

    return field


def cone(a: Point, b: Point, radius_a: float, radius_b: float) -> Field:
    """Capsule from `a` to `b` whose radius changes linearly (not an exact distance when the radii differ)."""
    d = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    length2 = d[0] ** 2 + d[1] ** 2 + d[2] ** 2

    def field(x: Array, y: Array, z: Array) -> Array:
        u, v, w = x - a[0], y - a[1], z - a[2]
        t = np.minimum(np.maximum((u * d[0] + v * d[1] + w * d[2]) / length2, 0.0), 1.0)
        distance = np.sqrt((u - t * d[0]) ** 2 + (v - t * d[1]) ** 2 + (w - t * d[2]) ** 2)
        return distance - (radius_a + t * (radius_b - radius_a))

    return field


def quadrant(axis_a: str, bound_a: float, axis_b: str, bound_b: float) -> Field:
    """Region beyond two planes; a negative-going axis is written "-x" (then the region is x < bound)."""

    def side(axis: str, bound: float, p: tuple[Array, Array, Array]) -> Array:
        value = p["xyz".index(axis[-1])]
        return value - bound if axis[0] == "-" else bound - value

    def field(x: Array, y: Array, z: Array) -> Array:
        return np.maximum(side(axis_a, bound_a, (x, y, z)), side(axis_b, bound_b, (x, y, z)))

    return field


def union(first: Field, *others: Field, blend: float) -> Field:
    """Union whose concave seams are filled by a fillet about `blend` wide (quadratic smooth minimum)."""

    def field(x: Array, y: Array, z: Array) -> Array:
        d = first(x, y, z)
        for other in others:
            e = other(x, y, z)
            h = np.maximum(blend - np.abs(d - e), 0.0) / blend
            d = np.minimum(d, e) - 0.25 * blend * h * h
        return d

    return field


def cut(body: Field, *tools: Field, blend: float) -> Field:
    """`body` without `tools`, with edges rounded about `blend` wide."""

    def field(x: Array, y: Array, z: Array) -> Array:
        d = body(x, y, z)
        for tool in tools:
            e = -tool(x, y, z)
            h = np.maximum(blend - np.abs(d - e), 0.0) / blend
            d = np.maximum(d, e) + 0.25 * blend * h * h
        return d

    return field
