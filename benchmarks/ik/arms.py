"""Arms whose inverse kinematics is measured, and poses that they can reach."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import manyhands as mh
from manyhands import kinematics as kin
from manyhands import robots

Array = NDArray[np.float64]

TOLERANCE = 1e-6  # [m, rad]
_HAIR = 1e-9  # of the judge's own rounding


@dataclass(frozen=True)
class Arm:
    """An arm that ships, and the frame that is brought to poses."""

    name: str
    path: Path
    frame: str

    @cached_property
    def model(self) -> mh.Model:
        return mh.load_urdf(self.path, load_meshes=False)[0]

    @cached_property
    def limits(self) -> tuple[Array, Array]:
        """(nq,) each; where a joint has none, half a turn to both sides."""
        moving = [joint for joint in self.model.joints if joint.iq >= 0]
        lower, upper = np.array([(joint.lower, joint.upper) for joint in moving]).T
        return np.where(np.isfinite(lower), lower, -np.pi), np.where(np.isfinite(upper), upper, np.pi)


@dataclass(frozen=True)
class Poses:
    """n poses of an arm's frame, and the configurations that they were made from."""

    q: Array
    position: Array
    quaternion: Array


def arms() -> Iterator[Arm]:
    """All arms that ship."""
    for name in robots.names("arm"):
        robot = robots.describe(name)
        yield Arm(name, robots.path(name), robot.flange or robot.tool)
    for name in ("panda", "arm6"):
        yield Arm(name, Path(mh.asset_path(f"{name}/{name}.urdf")), f"{name}_grasptarget")


def reachable(arm: Arm, count: int, seed: int = 0) -> Poses:
    """Of random configurations within the limits."""
    q = np.random.default_rng(seed).uniform(*arm.limits, (count, arm.model.nq))
    return Poses(q, *kin.forward(arm.model, q, arm.frame))


def errors(arm: Arm, poses: Poses, q: Array) -> tuple[Array, Array]:
    """How far q (n, nq) is from the poses, by forward kinematics: (n,) [m] and (n,) [rad]."""
    position, quaternion = kin.forward(arm.model, q, arm.frame)
    wanted, found = kin.matrix(poses.position, poses.quaternion), kin.matrix(position, quaternion)
    turn = np.swapaxes(wanted[:, :3, :3], 1, 2) @ found[:, :3, :3]
    twice_sine = np.linalg.norm(turn[:, [2, 0, 1], [1, 2, 0]] - turn[:, [1, 2, 0], [2, 0, 1]], axis=1)
    angle = np.arctan2(twice_sine, np.trace(turn, axis1=1, axis2=2) - 1)
    return np.linalg.norm(position - poses.position, axis=1), angle


def solved(arm: Arm, poses: Poses, q: Array) -> NDArray[np.bool_]:
    """(n,) whether q (n, nq) is within the limits and reaches the poses to TOLERANCE."""
    lower, upper = arm.limits
    within = ((q >= lower - _HAIR) & (q <= upper + _HAIR)).all(axis=1)
    return np.logical_and.reduce([within, *(error <= TOLERANCE + _HAIR for error in errors(arm, poses, q))])
