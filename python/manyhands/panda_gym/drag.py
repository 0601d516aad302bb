"""The air's drag, as Bullet has it: an acceleration of -u (0.04 + 0.04 |u|), u being the velocity or the turning."""

from dataclasses import dataclass
from math import sqrt

from manyhands._core import World

_DRAG = 0.04


@dataclass(frozen=True)
class FreeShape:
    """A uniform shape that moves freely."""

    link: str
    iv: int
    """Where its velocity begins: angular (3), then linear (3), in its own axes."""
    mass: float
    moments: tuple[float, float, float]


def step(world: World, n: int, shapes: list[FreeShape]) -> None:
    """Advances by n steps, slowing the shapes by the air. Arms, which their motors hold, are not slowed."""
    if not shapes:
        world.step(n)
        return
    tau = world.tau.tolist()
    # Inertia grows with the mass, which the world may have been told anew.
    scales = [world.mass(shape.link) / shape.mass for shape in shapes]
    for _ in range(n):
        v = world.v.tolist()
        for shape, scale in zip(shapes, scales, strict=True):
            _slow(shape, scale, v, tau)
        world.tau = tau
        world.step()
    for shape in shapes:
        tau[shape.iv : shape.iv + 6] = [0.0] * 6
    world.tau = tau


def _slow(shape: FreeShape, scale: float, v: list[float], tau: list[float]) -> None:
    """Writes the drag's torque and force."""
    i = shape.iv
    wx, wy, wz, vx, vy, vz = v[i : i + 6]
    turning = -_DRAG * scale * (1 + sqrt(wx * wx + wy * wy + wz * wz))
    moving = -_DRAG * scale * shape.mass * (1 + sqrt(vx * vx + vy * vy + vz * vz))
    a, b, c = shape.moments
    tau[i : i + 6] = turning * a * wx, turning * b * wy, turning * c * wz, moving * vx, moving * vy, moving * vz
