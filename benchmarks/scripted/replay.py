"""A recording run again, in MuJoCo and here, from the same start by the same commands."""

from typing import Protocol

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import XYZW, Array, Scene, mujoco
from benchmarks.realfiles.accelerations import commands
from benchmarks.scripted.recording import Recording

FREQUENCY = 60.0  # [rad/s] of the servo that follows a recorded path


class Program(Protocol):
    """One of the two at work; states and forces are in MuJoCo's coordinates.

    Steps last as long as MuJoCo's model says; `substeps` of them, under one command, make a step that was recorded.
    """

    def state(self) -> tuple[Array, Array]:
        """qpos (nq), qvel (nv)."""
        ...

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        """Of all mocap bodies (nmocap, 3) [m], (nmocap, 4)."""
        ...

    def step(self, ctrl: Array, force: Array) -> None:
        """One recorded step under these commands (nu) and these further joint forces (nv)."""
        ...


class Theirs:
    """MuJoCo."""

    def __init__(self, scene: Scene, qpos: Array, qvel: Array, substeps: int = 1) -> None:
        self.model, self.data, self.substeps = scene.mujoco, mujoco.MjData(scene.mujoco), substeps
        self.data.qpos, self.data.qvel = qpos, qvel

    def state(self) -> tuple[Array, Array]:
        return self.data.qpos.copy(), self.data.qvel.copy()

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        self.data.mocap_pos, self.data.mocap_quat = position, wxyz

    def step(self, ctrl: Array, force: Array) -> None:
        self.data.ctrl, self.data.qfrc_applied = ctrl, force
        mujoco.mj_step(self.model, self.data, self.substeps)


class Ours:
    """manyhands. Further forces act on joints of one degree of freedom only: their coordinates are MuJoCo's."""

    def __init__(self, scene: Scene, qpos: Array, qvel: Array, substeps: int = 1) -> None:
        self.scene, self.substeps = scene, substeps
        self.world = mh.World(scene.ours, time_step=scene.mujoco.opt.timestep)
        self.world.q = scene.configuration(qpos)
        self.world.v = scene.velocity_map(qpos) @ qvel
        self.command = commands(scene)
        model, names = scene.mujoco, scene.names("body", scene.mujoco.nbody)
        bodies = {int(model.body_mocapid[i]): name for i, name in enumerate(names)}
        self.mocap = [bodies[k] for k in range(model.nmocap)]

    def state(self) -> tuple[Array, Array]:
        qpos = self.scene.qpos(self.world.q)
        return qpos, np.linalg.inv(self.scene.velocity_map(qpos)) @ self.world.v

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        for name, at, turned in zip(self.mocap, position, wxyz, strict=True):
            self.world.set_mocap(name, at, turned[XYZW] / np.linalg.norm(turned))

    def step(self, ctrl: Array, force: Array) -> None:
        self.world.ctrl, self.world.tau = ctrl[self.command], force
        self.world.step(self.substeps)


class Servo:
    """Joint forces that keep an arm on its recorded path, the same in both programs.

    A recorded torque alone does not carry an arm far: the error of one contact grows for seconds. Nor does the motion
    of a mocap body, where MuJoCo's soft weld lets the hand trail behind. Here the joints that motors drive, and those
    that carry what is welded to a mocap body, feel

        f_r + M (w^2 (q_r - q) + 2 w (v_r - v))

    with their recorded positions q_r and velocities v_r, their inertia M at q_r, and the weld's force on them f_r in
    MuJoCo; the weld itself is gone (`led_scene`), and motors get their recorded commands as well.
    """

    def __init__(self, recorded: Scene, recording: Recording) -> None:
        """recorded: the scene with its welds."""
        model = recorded.mujoco
        motors = (model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)) & (
            model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_NONE)
        )
        joints = {int(joint) for joint in model.actuator_trnid[motors, 0]}
        for hand in welded_to_mocap(recorded):
            joints |= joints_that_carry(recorded, hand)
        led = sorted(joints)
        self.iq, self.iv = model.jnt_qposadr[led], model.jnt_dofadr[led]
        self.scene, self.recording = recorded, recording

    def force(self, k: int, program: Program) -> Array:
        """(nv) for step k."""
        recording, w = self.recording, FREQUENCY
        qpos, qvel = program.state()
        e, de = (recording.qpos[k] - qpos)[self.iq], (recording.qvel[k] - qvel)[self.iv]
        M, welds = self.recorded(k)
        force = np.zeros(self.scene.mujoco.nv)
        force[self.iv] = welds[self.iv] + M[np.ix_(self.iv, self.iv)] @ (w**2 * e + 2 * w * de)
        return force

    def recorded(self, k: int) -> tuple[Array, Array]:
        """The mass matrix (nv, nv) and the joint forces of equality constraints (nv) in MuJoCo, before step k."""
        model, data, recording = self.scene.mujoco, self.scene.data, self.recording
        for name in ("qpos", "qvel", "ctrl", "mocap_pos", "mocap_quat"):
            setattr(data, name, getattr(recording, name)[k])
        mujoco.mj_forward(model, data)
        M, welds = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
        mujoco.mj_fullM(model, data, M)
        equality = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        if np.any(equality):
            mujoco.mj_mulJacTVec(model, data, welds, np.where(equality, data.efc_force, 0.0))
        return M, welds


def welded_to_mocap(scene: Scene) -> list[int]:
    """MuJoCo's numbers of the bodies that welds bind to mocap bodies."""
    model = scene.mujoco
    welds = model.eq_type == int(mujoco.mjtEq.mjEQ_WELD)
    pairs = np.stack([model.eq_obj1id[welds], model.eq_obj2id[welds]], axis=1)
    return [int(b) for pair in pairs for a, b in (pair, pair[::-1]) if model.body_mocapid[a] >= 0]


def joints_that_carry(scene: Scene, body: int) -> set[int]:
    """Those between it and the world."""
    found = set[int]()
    while body > 0:
        first = int(scene.mujoco.body_jntadr[body])
        found |= set(range(first, first + int(scene.mujoco.body_jntnum[body])))
        body = int(scene.mujoco.body_parentid[body])
    return found


def replay(recording: Recording, program: Program, servo: Servo | None = None) -> Array:
    """qpos before the first step and after every one (n + 1, nq)."""
    states, none = [program.state()[0]], np.zeros(recording.qvel.shape[1])
    for k in range(len(recording.ctrl)):
        program.set_mocap(recording.mocap_pos[k], recording.mocap_quat[k])
        program.step(recording.ctrl[k], none if servo is None else servo.force(k, program))
        states.append(program.state()[0])
    return np.array(states)
