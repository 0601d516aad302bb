"""Own: what must stand for a minute: towers, an arch without mortar, a wall."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from benchmarks.accuracy.case import Case, Figure, Measurement, Settings, once, steps
from benchmarks.accuracy.engines import build
from benchmarks.accuracy.measures import corners, finite, placed, residuals
from benchmarks.accuracy.scene import Array, Body, Geom, Scene, about, ground, rotation

STAND = 60.0  # [s]
FRICTION = 0.6
STONES, INNER, OUTER, DEPTH, DENSITY = 9, 0.35, 0.45, 0.1, 2000.0  # [, m, m, m, kg/m^3]
BRICK, GAP = (0.1, 0.05, 0.03), 0.001  # half extents, and the joint between bricks of a row [m]
FALLEN = 0.01  # [m] that a stone may move before its structure counts as fallen


def stacked(sizes: Sequence[tuple[tuple[float, float, float], float]]) -> Scene:
    """Boxes (half extents, mass), one on the other, just touching."""
    bodies, top = [], 0.0
    for k, (size, mass) in enumerate(sizes):
        bodies.append(Body(f"box{k}", (Geom("box", size, FRICTION),), mass, (0, 0, top + size[2])))
        top += 2 * size[2]
    return Scene((ground(FRICTION), *bodies), extent=0.1)


def tower_scene() -> Scene:
    """20 cubes of 4 cm and 1 kg."""
    return stacked([((0.02, 0.02, 0.02), 1.0)] * 20)


def heavy_scene() -> Scene:
    """10 storeys, each a card of 100 g under a block of 10 kg."""
    return stacked([((0.05, 0.05, 0.01), 0.1), ((0.05, 0.05, 0.02), 10.0)] * 10)


def depth(scene: Scene, p: Array, quat: Array) -> float:
    """How deep a corner of a box is below the top of the box under it, or of the ground [m]."""
    boxes = scene.moving()
    worst = 0.0
    for k, box in enumerate(boxes):
        points = placed(p[k], quat[k], corners(box.geoms[0].size))
        if k == 0:
            gap = points[:, 2]
        else:
            gap = (points - p[k - 1]) @ rotation(quat[k - 1])[:, 2] - boxes[k - 1].geoms[0].size[2]
        worst = max(worst, -float(gap.min()))
    return worst


def stand(scene: Scene, settings: Settings, seconds: float = STAND) -> tuple[Array, float, Measurement]:
    """How far each body is from where it stood (n), the greatest depth from the first second on, and the rest."""
    sim = build(scene, settings)
    names = [body.name for body in scene.moving()]
    start = sim.states(names)[0]
    depths = [0.0]
    stacked_boxes = "box0" in names

    def look() -> None:
        if stacked_boxes and sim.time > 1:
            p, quat, _, _ = sim.states(names)
            depths.append(depth(scene, p, quat))

    sim.run(seconds, 0.5, look)
    rtf = sim.rtf
    moved = np.linalg.norm(sim.states(names)[0] - start, axis=1)
    return moved, max(depths), Measurement([], rtf, residuals(sim, 2))


def tower(scene: Scene, settings: Settings, depth_bound: float | None = None) -> Measurement:
    """The top's motion, and depth."""
    moved, deep, result = stand(scene, settings)
    result.figures += [
        Figure("motion of the top in 60 s", finite(moved[-1] * 1e3), "mm", 1.0),
        Figure("penetration", finite(deep * 1e3), "mm", depth_bound),
    ]
    return result


def structure(scene: Scene, settings: Settings) -> Measurement:
    """The stone that has moved the most."""
    moved, _, result = stand(scene, settings)
    result.figures.append(Figure("greatest motion in 60 s", finite(moved.max() * 1e3), "mm", FALLEN * 1e3))
    return result


def arch_scene() -> Scene:
    """A half circle of 9 equal stones; thick enough to stand (a tenth of the radius is the least)."""
    half = np.pi / STONES / 2
    c, s = np.cos(half), np.sin(half)
    section = np.array(
        [(INNER * c, INNER * s), (OUTER * c, OUTER * s), (OUTER * c, -OUTER * s), (INNER * c, -INNER * s)]
    )
    x, y = section.T
    nx, ny = np.roll(x, -1), np.roll(y, -1)
    cross = x * ny - nx * y
    area = cross.sum() / 2
    middle = ((x + nx) * cross).sum() / 6 / area  # of area, on the stone's own axis
    xx = ((x * x + x * nx + nx * nx) * cross).sum() / 12 / area - middle**2
    yy = ((y * y + y * ny + ny * ny) * cross).sum() / 12 / area
    mass = float(DENSITY * abs(area) * DEPTH)
    zz = DEPTH**2 / 12
    inertia = (float(mass * (yy + zz)), float(mass * (xx + zz)), float(mass * (xx + yy)))
    vertices = tuple((float(u - middle), float(v), w) for u, v in section for w in (-DEPTH / 2, DEPTH / 2))
    stones = []
    for k in range(STONES):
        angle = np.pi * (k + 0.5) / STONES
        upright, turn = about((1, 0, 0), np.pi / 2), about((0, 0, 1), angle)
        stones.append(
            Body(
                f"stone{k}",
                (Geom("hull", (), FRICTION, vertices=vertices),),
                mass,
                (middle * np.cos(angle), 0.0, middle * np.sin(angle)),
                multiplied(upright, turn),
                inertia=inertia,
            )
        )
    return Scene((ground(FRICTION), *stones), extent=0.5)


def multiplied(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """The turn b, then a (quaternions xyzw)."""
    u, v = np.array(a[:3]), np.array(b[:3])
    xyz = a[3] * v + b[3] * u + np.cross(u, v)
    return (float(xyz[0]), float(xyz[1]), float(xyz[2]), float(a[3] * b[3] - u @ v))


def wall_scene() -> Scene:
    """10 courses of 10 bricks; every other course begins and ends with half a brick."""
    x, y, z = BRICK
    pitch = 2 * x + GAP
    bodies = []
    for row in range(10):
        if row % 2 == 0:
            course = [(k * pitch, x) for k in range(10)]
        else:
            course = [((k + 0.5) * pitch, x) for k in range(9)]
            short = x / 2 - GAP / 4
            course = [(-x + short, short), *course, (9 * pitch + x - short, short)]
        for k, (place, half) in enumerate(course):
            mass = 2.0 * half / x
            geom = Geom("box", (half, y, z), FRICTION)
            bodies.append(Body(f"brick{row}_{k}", (geom,), mass, (place - 4.5 * pitch, 0, z * (2 * row + 1))))
    return Scene((ground(FRICTION), *bodies), extent=1.0)


def tower_run(settings: Settings) -> Measurement:
    """20 cubes."""
    return tower(tower_scene(), settings)


def heavy_run(settings: Settings) -> Measurement:
    """Heavy on light."""
    return tower(heavy_scene(), settings, 0.1)


def arch_run(settings: Settings) -> Measurement:
    """9 stones."""
    return structure(arch_scene(), settings)


def wall_run(settings: Settings) -> Measurement:
    """105 bricks."""
    return structure(wall_scene(), settings)


CASES = [
    Case("tower", "20 cubes of 4 cm, 60 s", tower_run, steps, partial(once, time_step=0.004)),
    Case("heavy on light", "10 storeys, masses 100 to 1, 60 s", heavy_run, steps, partial(once, time_step=0.004)),
    Case("arch", "9 stones without mortar, 60 s", arch_run, steps, partial(once, time_step=0.004)),
    Case("wall", "105 bricks without mortar, 60 s", wall_run, steps),
]
