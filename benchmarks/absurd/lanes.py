"""The same scenes in single precision, in the lanes of a Batch."""

import numpy as np

import manyhands as mh
from benchmarks.absurd.energy import Ledger
from benchmarks.absurd.setting import Setting

WORLDS = 3
MOST_ENERGY = 100.0  # times what there can be: single precision leaves corrections more
STANDS_STILL = 1  # the bit of Batch.flags


def run(setting: Setting, world: mh.World, steps: int) -> tuple[str, float]:
    """What became of it, "held", "flagged" or what is wrong, and the largest ratio of energies. `world`: at its start,
    which is lent to reckon energies."""
    batch = mh.Batch(world.model, WORLDS, world.time_step, num_threads=1)
    batch.q, batch.v, batch.ctrl = world.q, world.v, world.ctrl
    if setting.motors > 0:
        batch.set_motors(target_q=setting.targets, kp=0.1, max_force=setting.forces)
    ledger = Ledger(setting, world)
    for step in range(steps):
        for jump in setting.jumps_at(step):
            batch.set_mocap(jump.body, jump.position, jump.quaternion)
            world.set_mocap(jump.body, jump.position, jump.quaternion)
        batch.step()
        q, v = batch.q.astype(np.float64), batch.v.astype(np.float64)
        if not (np.isfinite(q).all() and np.isfinite(v).all()):
            return "a state that is not finite", ledger.ratio
        if not ((q == q[0]).all() and (v == v[0]).all()):
            return "lanes differ", ledger.ratio
        if batch.flags[0] & STANDS_STILL:
            return "flagged", ledger.ratio
        world.q, world.v = unit_quaternions(world.model, q[0]), v[0]
        ledger.see(world)
        if not ledger.ratio <= MOST_ENERGY:
            return "energy from nowhere", ledger.ratio
    return "held", ledger.ratio


def unit_quaternions(model: mh.Model, q: np.ndarray) -> np.ndarray:
    """With the length that single precision loses."""
    for joint in model.joints:
        if joint.type in ("floating", "spherical"):
            end = joint.iq + joint.nq
            q[end - 4 : end] /= np.linalg.norm(q[end - 4 : end])
    return q
