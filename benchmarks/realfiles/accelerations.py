"""Accelerations at the initial state and at random ones beside MuJoCo's."""

from collections.abc import Iterator

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import BALL, FREE, Array, MjModel, Scene, mujoco

TOLERANCE = 1e-6  # relative to the largest acceleration of the state, or to 1
STATES = 20
TRIES = 400
TIME_STEPS = (1e-5, 1e-7, 1e-9)  # [s] of the differences; stiff files need the short ones, light ones the long
APART = 20.0  # [m] between free bodies
SPEEDS = (0.1, 1.0)  # [rad/s or m/s] of every dof, either way: none so slow that friction stops it
AT_LIMIT = 1e-6  # [rad or m]: MuJoCo's joints pass their limits before they are stopped
# Rows of MuJoCo's constraints that are exact: dry friction at its bound, against the motion.
FRICTIONS = (int(mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF), int(mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON))


class Peer:
    """Our worlds of the scene's model, one for each time step that differences need."""

    def __init__(self, scene: Scene) -> None:
        self.worlds = {h / k: mh.World(scene.ours, time_step=h / k) for h in TIME_STEPS for k in (1, 2)}
        self.command, self.activation = commands(scene), activations(scene)

    def accelerations(self, q: Array, v: Array, ctrl: Array, act: Array) -> list[Array] | None:
        """(nv) at the state, extrapolated to a time step of 0, for each of TIME_STEPS; None if something touches."""
        found = []
        for h in TIME_STEPS:
            rates = []
            for step in (h, h / 2):
                world = self.worlds[step]
                world.q, world.v = q, v
                world.ctrl, world.act = ctrl[self.command], act[self.activation]
                world.forget()
                world.step()
                if world.contacts():
                    return None
                rates.append((world.v - v) / step)
            found.append(2 * rates[1] - rates[0])
        return found


def commands(scene: Scene) -> list[int]:
    """MuJoCo's number of each of our actuators."""
    names = {name: i for i, name in enumerate(scene.names("actuator", scene.mujoco.nu))}
    return [names[actuator.name] for actuator in scene.ours.actuators]


def activations(scene: Scene) -> list[int]:
    """Where MuJoCo has each of our activations."""
    driven = [i for i, ours in zip(commands(scene), scene.ours.actuators, strict=True) if ours.iact >= 0]
    return [int(scene.mujoco.actuator_actadr[i]) for i in driven]


def compare(scene: Scene) -> dict[str, float | int | str]:
    """At how many states, the largest difference, at which state, and of which joint."""
    peer = Peer(scene)
    found: dict[str, float | int | str] = {"states": 0, "away": 0.0, "where": "", "error": ""}
    for name, qpos, qvel, ctrl, act in states(scene):
        theirs = acceleration(scene, qpos, qvel, ctrl, act)
        if theirs is None:
            continue
        G = scene.velocity_map(qpos)
        try:
            ours = peer.accelerations(scene.configuration(qpos), G @ qvel, ctrl, act)
        except (mh.SimulationError, ValueError) as why:
            return found | {"error": f"{name}: {why}".splitlines()[0][:300]}
        if ours is None:
            continue
        exact = G @ theirs
        differences = [np.abs(a - exact) / max(1.0, float(np.max(np.abs(exact)))) for a in ours]
        nearest = min(differences, key=np.max)
        found["states"] = int(found["states"]) + 1
        if float(np.max(nearest)) > float(found["away"]):
            dof = int(np.argmax(nearest))
            found |= {"away": float(nearest[dof]), "where": f"{name}, {joint_of(scene, dof)}"}
        if found["states"] == STATES + 1:
            break
    return found


def states(scene: Scene) -> Iterator[tuple[str, Array, Array, Array, Array]]:
    """The initial state, then random ones within limits, free bodies far apart."""
    model, rng = scene.mujoco, np.random.default_rng(0)
    yield "initial state", np.array(model.qpos0), np.zeros(model.nv), np.zeros(model.nu), np.zeros(model.na)
    for k in range(TRIES):
        qvel = rng.uniform(*SPEEDS, model.nv) * rng.choice((-1.0, 1.0), model.nv)
        yield f"state {k}", random_qpos(model, rng), qvel, random_ctrl(model, rng), rng.uniform(-1, 1, model.na)


def random_qpos(model: MjModel, rng: np.random.Generator) -> Array:
    """Joints anywhere in their ranges, but never at an end."""
    qpos = rng.uniform(-2, 2, model.nq)
    for i, (kind, at) in enumerate(zip(model.jnt_type, model.jnt_qposadr, strict=True)):
        if kind == FREE:
            qpos[at : at + 3] += (APART * i, 0, APART)
        elif model.jnt_limited[i] and kind > BALL:
            lower, upper = model.jnt_range[i]
            qpos[at] = lower + (upper - lower) * rng.uniform(0.1, 0.9)
    mujoco.mj_normalizeQuat(model, qpos)
    return qpos


def random_ctrl(model: MjModel, rng: np.random.Generator) -> Array:
    """Within their ranges, or within 1."""
    limited = model.actuator_ctrllimited.astype(bool)
    lower = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    upper = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    return rng.uniform(lower, upper)


def acceleration(scene: Scene, qpos: Array, qvel: Array, ctrl: Array, act: Array) -> Array | None:
    """MuJoCo's (nv); None where one of its soft constraints acts."""
    model, data = scene.mujoco, scene.data
    mujoco.mj_resetData(model, data)
    data.qpos, data.qvel, data.ctrl, data.act = qpos, qvel, ctrl, act
    mujoco.mj_forward(model, data)
    at_bound = np.abs(data.efc_force) >= (1 - 1e-12) * data.efc_frictionloss  # efc_state is that of an earlier iterate
    exact = np.isin(data.efc_type, FRICTIONS) & at_bound & (data.efc_force * data.efc_vel < 0)
    hard = bool(np.all(exact)) and not data.ncon and not at_limit(model, data.qpos)
    return np.array(data.qacc) if hard else None


def at_limit(model: MjModel, qpos: Array) -> bool:
    """Whether a joint stands at an end of its range."""
    limited = np.flatnonzero(model.jnt_limited.astype(bool) & (model.jnt_type > BALL))
    away = np.abs(model.jnt_range[limited] - qpos[model.jnt_qposadr[limited], None])
    return bool(np.any(away < AT_LIMIT))


def joint_of(scene: Scene, dof: int) -> str:
    """The name of the joint that has it."""
    return scene.names("joint", scene.mujoco.njnt)[scene.mujoco.dof_jntid[dof]]
