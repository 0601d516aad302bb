#!/usr/bin/env python3
"""Render docs/images/panda_reach.png: the arm in its neutral pose at a table, and the goal it reaches for.

    pip install numpy embreex pillow
    python tools/make_pictures.py [--robot panda|arm6] [--passes 80] [--scale 1.0] [--out FILE]

Runs on the CPU, a few seconds per pass; each pass adds one sample per pixel.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent))

from robots import mesh, scene, trace

ROOT = Path(__file__).resolve().parent.parent
NEUTRAL = {
    "panda": [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.02, 0.02],
    "arm6": [-0.209817, -1.198085, 1.524398, -1.89711, -1.570796, -0.209817, 0.02, 0.02],
}
BASE = (-0.6, 0.0, 0.0)
TABLE = (1.1, 0.7, 0.4)  # m, top at z = 0, centred at x = -0.3
GOLDEN = 0.6180339887498949  # multiples of it, modulo 1, spread evenly
Array = npt.NDArray[np.float64]

MATERIALS = {
    "shell": trace.Material((0.86, 0.865, 0.875), 0.045, 0.22),
    "graphite": trace.Material((0.030, 0.034, 0.042), 0.045, 0.30),
    "accent": trace.Material((0.95, 0.25, 0.03), 0.04, 0.25),
    "metal": trace.Material((0.56, 0.57, 0.60), 0.5, 0.35),
    "table": trace.Material((0.56, 0.475, 0.385), 0.04, 0.36),
    "plinth": trace.Material((0.045, 0.055, 0.065), 0.0, 1.0),
    "floor": trace.Material((0.11, 0.18, 0.22), 0.0, 1.0),
}
OWN_MATERIALS = {
    "arm6": {
        "shell": trace.Material((0.80, 0.82, 0.83), 0.045, 0.22),
        "accent": trace.Material((0.01, 0.30, 0.36), 0.04, 0.25),
    },
}
LIGHTS = [
    trace.Light((-0.50, -0.55, 1.0), (11.5, 10.6, 9.4), 0.24),
    trace.Light((0.55, 0.95, 0.50), (4.2, 5.2, 6.4), 0.24),
    trace.Light((1.0, -0.60, 0.35), (1.7, 1.65, 1.6), 0.40),
]
SKY = ((0.06, 0.075, 0.09), (0.25, 0.285, 0.33))
GOAL = trace.Ball((0.135, -0.065, 0.150), 0.02, (0.05, 0.80, 0.22), 0.55, 0.16)


def slab(length: float, width: float, low: float, high: float) -> mesh.Mesh:
    """Bevelled box about the z axis."""
    y = width / 2
    return mesh.prism([(-y, low), (y, low), (y, high), (-y, high)], length / 2, 0.003)


def build(name: str) -> trace.Tracer:
    """The whole scene about the robot in assets/`name`."""
    base = np.eye(4)
    base[:3, 3] = BASE
    robot = scene.posed_robot(ROOT / f"assets/{name}/{name}.urdf", NEUTRAL[name], base)
    height = TABLE[2]
    top = scene.placed(slab(TABLE[0], TABLE[1], -0.035, 0.0), (-0.3, 0.0, 0.0), "table")
    plinth = scene.placed(slab(TABLE[0] - 0.12, TABLE[1] - 0.12, -height, -0.035), (-0.3, 0.0, 0.0), "plinth")
    square = [(-30.0, -30.0), (30.0, -30.0), (30.0, 30.0), (-30.0, 30.0)]
    corners = np.array([[(*square[i], -height) for i in face] for face in ((0, 1, 2), (0, 2, 3))])
    floor = scene.Triangles(corners, np.broadcast_to([0.0, 0.0, 1.0], corners.shape).copy(), [("floor", 2)])
    soup = scene.together(robot, top, plinth, floor)
    materials = MATERIALS | OWN_MATERIALS.get(name, {})
    return trace.Tracer(soup, materials, LIGHTS, GOAL, SKY, ((-0.3, 0.0, 0.0), 0.9, 3.2))


def backdrop(camera: trace.Camera) -> Array:
    """Studio wall: a soft glow behind the arm over a gradient; (pixels, 3)."""
    y, x = np.mgrid[0 : camera.height, 0 : camera.width]
    u, v = (x - 0.5 * camera.width) / camera.height, (y - 0.42 * camera.height) / camera.height
    glow = np.exp(-(u * u / 0.5 + v * v / 0.22))[..., None]
    low, high = np.array([0.030, 0.062, 0.084]), np.array([0.20, 0.32, 0.37])
    return (low + (high - low) * glow).reshape(-1, 3)


def filtered(light: Array, colour: Array, normal: Array, rounds: int) -> Array:
    """Edge-stopping a-trous wavelet filter (Dammertz et al. 2010) of the light divided by the surface colour."""
    value = light / (colour + 0.02)
    kernel = {-2: 1 / 16, -1: 1 / 4, 0: 3 / 8, 1: 1 / 4, 2: 1 / 16}
    for level in range(rounds):
        total, weights = np.zeros_like(value), np.zeros((*value.shape[:2], 1))
        for dy, wy in kernel.items():
            for dx, wx in kernel.items():
                shift = (dy << level, dx << level)

                def moved(a: Array, shift: tuple[int, int] = shift) -> Array:
                    return np.roll(a, shift, axis=(0, 1))

                w = np.exp(-((moved(normal) - normal) ** 2).sum(-1, keepdims=True) / 0.02)
                w = w * np.exp(-((moved(colour) - colour) ** 2).sum(-1, keepdims=True) / 0.002)
                contrast = ((moved(value) - value) / (value + 0.1)) ** 2
                w = wx * wy * w * np.exp(-contrast.sum(-1, keepdims=True) / (0.12 / 4**level))
                total += w * moved(value)
                weights += w
        value = total / weights
    return value * (colour + 0.02)


def develop(light: Array, exposure: float) -> npt.NDArray[np.uint8]:
    """Film curve (Narkowicz' fit of ACES) and sRGB."""
    x = light * exposure
    x = np.clip(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0, 1)
    srgb = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    return np.round(255 * srgb).astype(np.uint8)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", choices=sorted(NEUTRAL), default="panda")
    parser.add_argument("--passes", type=int, default=80, help="samples per pixel")
    parser.add_argument("--scale", type=float, default=1.0, help="size relative to 1200 x 800")
    parser.add_argument("--out", type=Path, help="default: docs/images/ROBOT_reach.png")
    args = parser.parse_args()
    out = args.out or ROOT / f"docs/images/{args.robot}_reach.png"
    size = (round(1200 * args.scale), round(800 * args.scale))
    camera = trace.Camera((0.88, -1.30, 0.60), (-0.205, 0.0, 0.262), 30.5, *size)
    tracer, wall, rng = build(args.robot), backdrop(camera), np.random.default_rng(1)
    lobe = rng.random(size[0] * size[1])
    sums = [np.zeros((size[0] * size[1], 3)) for _ in range(3)]
    for number in range(args.passes):
        samples = tracer.sample(*camera.rays(rng), wall, (lobe + number * GOLDEN) % 1.0, rng)
        # A ceiling on single samples keeps rare bright paths from leaving specks.
        for total, part in zip(sums, (np.minimum(samples[0], 8.0), *samples[1:]), strict=True):
            total += part
        print(f"\rpass {number + 1} of {args.passes}", end="", flush=True)
    light, colour, normal = (s.reshape(size[1], size[0], 3) / args.passes for s in sums)
    out.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(develop(filtered(light, colour, normal, 3), 0.9)).save(out, optimize=True)
    print(f"\n{out}: {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
