"""Makes a world forget what its solver remembers, so that what follows depends on where things are alone."""

import numpy as np

from manyhands._core import Model, World
from manyhands.panda_gym.rotations import Array

_HEAD = 5  # fingerprint, time step, steps, whether forces are applied, numbers of contacts


def forget(world: World) -> None:
    """Starts the clock anew; warm starts of joints, loops and contacts are those of a world that never moved."""
    snapshot = world.snapshot()
    model = world.model
    snapshot[2] = 0
    snapshot[_remembered(model, snapshot)] = 0
    world.restore(snapshot)


def _remembered(model: Model, snapshot: Array) -> slice:
    """Where a snapshot holds warm starts: behind q, v and the commands, and before the masses of the links."""
    nq, nv = model.nq, model.nv
    first = _HEAD + nq + 4 * nv
    loops = sum(6 if loop.type in ("hinge", "fixed", "prismatic", "slider") else 3 for loop in model.loops)
    end = first + 3 * nv + model.nu + loops + int(snapshot[4])
    masses = World(model).snapshot()
    same = np.array([link.mass for link in model.links])
    if not np.array_equal(masses[end : end + len(same)], same):
        raise RuntimeError("a World's snapshot is laid out otherwise than manyhands.panda_gym.memory knows")
    return slice(first, end)
