"""Runs written down, to be plotted: joints, forces, contact, the hand's path and rewards."""

import zipfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core import World
from manyhands.files import replacing
from manyhands.measures import contact_forces, hand_of, joint_forces, joints_of

Array = NDArray[np.float64]


@dataclass
class Recording:
    """n moments of a run. Joints (k) are those of one degree of freedom; what was not measured is empty."""

    time: Array
    """(n) [s]"""
    joints: list[str]
    positions: Array
    """(n, k) [rad or m]"""
    velocities: Array
    """(n, k) [rad/s or m/s]"""
    forces: Array
    """(n, k), what drove the joints [N m or N]."""
    touched: list[str]
    """The links (m) that were touched at some time."""
    contacts: Array
    """(n, m), the sum of the normal forces on each [N]."""
    hand: Array
    """(n, 3), the path of the end-effector [m]."""
    rewards: Array
    """(n), or empty."""

    def save(self, path: str | Path) -> Path:
        """Writes a file of numpy's, .npz, which is added to a name that ends otherwise. Returns its path."""
        path = Path(path)
        if path.suffix != ".npz":
            path = path.with_name(f"{path.name}.npz")
        arrays: dict[str, Any] = {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}
        with replacing(path) as temporary:
            np.savez_compressed(temporary, **arrays)
        return path

    @classmethod
    def load(cls, path: str | Path) -> "Recording":
        """What `save` wrote. Raises FileNotFoundError, ValueError on a file of something else."""
        path = Path(path)
        if path.is_file() and not zipfile.is_zipfile(path):
            raise ValueError(f"{path} is no recording: expected a file .npz that Recording.save wrote")
        with np.load(path) as file:
            if missing := [field.name for field in fields(cls) if field.name not in file]:
                raise ValueError(f"{path} is no recording: it has no {missing[0]}")
            given: dict[str, Any] = {field.name: file[field.name] for field in fields(cls)}
        given |= {name: given[name].tolist() for name in ("joints", "touched")}
        return cls(**given)


class Recorder:
    """Writes down a world, moment by moment: `add` after each step, then `recording`."""

    def __init__(self, recorded: Any) -> None:
        """recorded: a World, or an environment or simulation of `manyhands.panda_gym`; parts must neither come nor go
        while it is recorded. Raises TypeError on anything else: other environments do not tell their forces."""
        self._world = world = _world_of(recorded)
        self._joints, self._hand = joints_of(world.model), hand_of(world.model)
        self._rows: list[tuple[float, Array, Array, Array, Array]] = []
        self._contacts: list[dict[str, float]] = []
        self._rewards: list[float] = []

    def add(self, reward: float | None = None) -> None:
        """The present moment, and the reward of the step that led to it."""
        world, joints = self._world, self._joints
        hand = world.body_pose(self._hand)[0] if self._hand is not None else np.zeros(0)
        self._rows.append((world.time, world.q[joints.iq], world.v[joints.iv], joint_forces(world), hand))
        self._contacts.append(contact_forces(world))
        if reward is not None:
            self._rewards.append(reward)

    def recording(self) -> Recording:
        """All moments so far. Raises RuntimeError without any."""
        if not self._rows:
            raise RuntimeError("nothing has been recorded yet: call add() after each step")
        time, q, v, forces, hand = (np.array(column) for column in zip(*self._rows, strict=True))
        touched = sorted({link for row in self._contacts for link in row})
        contacts = np.array([[row.get(link, 0.0) for link in touched] for row in self._contacts])
        # Episodes begin anew at time 0; a recording goes on.
        restarts = np.concatenate([[0.0], np.cumsum(np.where(np.diff(time) < 0, -np.diff(time), 0.0))])
        return Recording(
            time + restarts, self._joints.names, q, v, forces, touched, contacts, hand, np.array(self._rewards)
        )


def _world_of(recorded: Any) -> World:
    inner = getattr(recorded, "unwrapped", recorded)
    for found in (inner, getattr(inner, "world", None), getattr(getattr(inner, "sim", None), "world", None)):
        if isinstance(found, World):
            return found
    raise TypeError(
        f"a {type(inner).__name__} cannot be recorded: expected a manyhands.World, or an environment that "
        "gymnasium.make gives after `import manyhands.panda_gym`, whose forces can be read"
    )
