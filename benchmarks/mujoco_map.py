"""A scene for MuJoCo and the same for us, and the map between their coordinates.

q is MuJoCo's qpos with quaternions turned from wxyz to xyzw. MuJoCo's velocity of a free joint is (linear in world
axes, angular in body axes), ours (angular, linear) in world axes; of a ball joint it has body axes, ours the joint's.
Hence v = G v_m, tau_m = G^T tau.
"""

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import manyhands as mh

Array = NDArray[np.float64]
mujoco: Any = import_module("mujoco")  # most of it has no stubs
MjModel = Any
MjData = Any
Compliance = Literal["stated", "all", "none"]

FREE, BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)
XYZW, WXYZ = [1, 2, 3, 0], [3, 0, 1, 2]


def rotation(wxyz: Array) -> Array:
    return Rotation.from_quat(np.asarray(wxyz)[XYZW]).as_matrix()


@dataclass
class Scene:
    """One file, loaded by both."""

    mujoco: MjModel
    ours: mh.Model
    report: mh.LoadReport

    @classmethod
    def of_string(cls, text: str, compliance: Compliance = "stated") -> "Scene":
        return cls(mujoco.MjModel.from_xml_string(text), *mh.load_mjcf_string(text, compliance=compliance))

    @classmethod
    def of_file(cls, path: Path) -> "Scene":
        theirs = mujoco.MjModel.from_xml_path(str(path))
        return cls(theirs, *mh.load_mjcf(path, allow_outside_package=True))

    @cached_property
    def data(self) -> MjData:
        return mujoco.MjData(self.mujoco)

    def names(self, kind: str, count: int) -> list[str]:
        """Names by MuJoCo's numbers, those of unnamed parts as we make them."""
        given = [getattr(self.mujoco, kind)(i).name for i in range(count)]
        return [name or self.unused(f"{kind}_{i}") for i, name in enumerate(given)]

    def unused(self, name: str) -> str:
        return name if f"\0{name}\0".encode() not in self.mujoco.names else self.unused(name + "_")

    def random_qpos(self, rng: np.random.Generator) -> Array:
        qpos = rng.uniform(-2, 2, self.mujoco.nq)
        mujoco.mj_normalizeQuat(self.mujoco, qpos)
        return qpos

    def configuration(self, qpos: Array) -> Array:
        """Our q of MuJoCo's qpos."""
        return self.with_quaternions(qpos, XYZW)

    def qpos(self, q: Array) -> Array:
        """MuJoCo's qpos of our q."""
        return self.with_quaternions(q, WXYZ)

    def with_quaternions(self, q: Array, order: list[int]) -> Array:
        """A copy in which they have that order."""
        q = np.array(q)
        for kind, start in zip(self.mujoco.jnt_type, self.mujoco.jnt_qposadr, strict=True):
            if kind in (FREE, BALL):
                at = start + (3 if kind == FREE else 0)
                q[at : at + 4] = q[at : at + 4][order]
        return q

    def velocity_map(self, qpos: Array) -> Array:
        """G (nv, nv)."""
        G = np.eye(self.mujoco.nv)
        joints = zip(self.mujoco.jnt_type, self.mujoco.jnt_qposadr, self.mujoco.jnt_dofadr, strict=True)
        for kind, iq, iv in joints:
            if kind == BALL:
                G[iv : iv + 3, iv : iv + 3] = rotation(qpos[iq : iq + 4])
            elif kind == FREE:
                G[iv : iv + 6, iv : iv + 6] = 0
                G[iv : iv + 3, iv + 3 : iv + 6] = rotation(qpos[iq + 3 : iq + 7])
                G[iv + 3 : iv + 6, iv : iv + 3] = np.eye(3)
        return G

    def body_inertia(self, i: int) -> Array:
        """About the centre of mass, in the body's axes (3, 3)."""
        R = rotation(self.mujoco.body_iquat[i])
        return R @ np.diag(self.mujoco.body_inertia[i]) @ R.T
