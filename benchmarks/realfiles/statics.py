"""Dofs, masses, poses, mass matrices and limits beside MuJoCo's."""

from dataclasses import dataclass

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import Array, Scene, mujoco, rotation

TOLERANCE = 1e-6  # of lengths in metres, of angles, of masses relative to the file's heaviest body
CONFIGURATIONS = 5


@dataclass
class Difference:
    """The largest of one kind, and where."""

    away: float = 0.0
    where: str = ""

    def note(self, away: float, where: str) -> None:
        """Keeps the larger; what is not finite is larger than all."""
        if not away <= self.away:
            self.away, self.where = away if np.isfinite(away) else np.inf, where

    @property
    def text(self) -> str:
        """Empty if it is within tolerance."""
        return "" if self.away <= TOLERANCE else f"{self.where} {self.away:.1e}"


def compare(scene: Scene) -> dict[str, str]:
    """What differs, by kind; empty strings where nothing does."""
    theirs, ours = scene.mujoco, scene.ours
    if (ours.nq, ours.nv) != (theirs.nq, theirs.nv):
        return {"dofs": f"{ours.nv} instead of {theirs.nv}"}
    try:
        found = {"dofs": "", "limits": limits(scene), "masses": masses(scene)}
        return found | poses_and_mass_matrices(scene)
    except KeyError as why:
        return {"dofs": "", "names": str(why).splitlines()[0][:200]}


def limits(scene: Scene) -> str:
    """Of joints with one coordinate."""
    most = Difference()
    for i, name in enumerate(scene.names("joint", scene.mujoco.njnt)):
        joint = scene.ours.joint(name)
        if joint.nq != 1:
            continue
        expected = scene.mujoco.jnt_range[i] if scene.mujoco.jnt_limited[i] else (-np.inf, np.inf)
        for a, b in zip((joint.lower, joint.upper), expected, strict=True):
            most.note(0.0 if a == b else abs(a - b), name)
    return most.text


def masses(scene: Scene) -> str:
    """Masses relative to the heaviest, centres of mass, inertias relative to their own largest."""
    model, most = scene.mujoco, Difference()
    heaviest = float(np.max(model.body_mass, initial=0.0)) or 1.0
    for i, name in enumerate(scene.names("body", model.nbody)):
        link = scene.ours.link(name)
        most.note(abs(link.mass - model.body_mass[i]) / heaviest, f"{name}: mass")
        if i == 0 or model.body_mass[i] <= TOLERANCE * heaviest:
            continue
        most.note(float(np.max(np.abs(link.com - model.body_ipos[i]))), f"{name}: centre of mass")
        largest = max(float(np.max(model.body_inertia[i])), 1e-12)
        most.note(float(np.max(np.abs(link.inertia - scene.body_inertia(i)))) / largest, f"{name}: inertia")
    return most.text


def poses_and_mass_matrices(scene: Scene) -> dict[str, str]:
    """In the initial and in random configurations; entries M_ij relative to sqrt(M_ii M_jj)."""
    model, data = scene.mujoco, scene.data
    poses, matrices, rng = Difference(), Difference(), np.random.default_rng(0)
    bodies = scene.names("body", model.nbody)
    for k in range(CONFIGURATIONS):
        data.qpos = model.qpos0 if k == 0 else scene.random_qpos(rng)
        mujoco.mj_forward(model, data)
        q = scene.configuration(data.qpos)
        for i, name in enumerate(bodies):
            poses.note(pose_away(scene.ours, q, name, data.xpos[i], rotation(data.xquat[i])), name)
        if model.nv:
            matrices.note(mass_matrix_away(scene, q), f"configuration {k}")
    return {"poses": poses.text, "mass matrix": matrices.text}


def pose_away(model: mh.Model, q: Array, name: str, position: Array, R: Array) -> float:
    """Of a body, relative to its distance from the origin where that is above 1 m."""
    p, quaternion = mh.dynamics.frame_pose(model, q, name)
    turned = float(np.max(np.abs(rotation(quaternion[[3, 0, 1, 2]]) - R)))
    return max(turned, float(np.max(np.abs(p - position)) / max(1.0, np.max(np.abs(position)))))


def mass_matrix_away(scene: Scene, q: Array) -> float:
    """In MuJoCo's coordinates."""
    model, data = scene.mujoco, scene.data
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    G = scene.velocity_map(data.qpos)
    scale = np.sqrt(np.maximum(np.diag(M), 1e-300))
    return float(np.max(np.abs(G.T @ mh.dynamics.crba(scene.ours, q) @ G - M) / np.outer(scale, scale)))
