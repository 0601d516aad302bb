"""A recording run again, in MuJoCo and here, from the same start by the same commands."""

from typing import Protocol

import numpy as np

import manyhands as mh
from benchmarks.mujoco_map import XYZW, Array, Scene, mujoco
from benchmarks.realfiles.accelerations import commands
from benchmarks.scripted.recording import Recording


class Program(Protocol):
    """One of the two at work; states are in MuJoCo's coordinates."""

    def state(self) -> tuple[Array, Array]:
        """qpos (nq), qvel (nv)."""
        ...

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        """Of all mocap bodies (nmocap, 3) [m], (nmocap, 4)."""
        ...

    def step(self, ctrl: Array) -> None:
        """One step under these commands (nu)."""
        ...


class Theirs:
    """MuJoCo."""

    def __init__(self, scene: Scene, qpos: Array, qvel: Array) -> None:
        self.model, self.data = scene.mujoco, mujoco.MjData(scene.mujoco)
        self.data.qpos, self.data.qvel = qpos, qvel

    def state(self) -> tuple[Array, Array]:
        return self.data.qpos.copy(), self.data.qvel.copy()

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        self.data.mocap_pos, self.data.mocap_quat = position, wxyz

    def step(self, ctrl: Array) -> None:
        self.data.ctrl = ctrl
        mujoco.mj_step(self.model, self.data)


class Ours:
    """manyhands."""

    def __init__(self, scene: Scene, qpos: Array, qvel: Array) -> None:
        self.scene, self.world = scene, mh.World(scene.ours)
        self.world.q = scene.configuration(qpos)
        self.world.v = scene.velocity_map(qpos) @ qvel
        self.command = commands(scene)
        model, names = scene.mujoco, scene.names("body", scene.mujoco.nbody)
        bodies = {int(model.body_mocapid[i]): name for i, name in enumerate(names)}
        self.mocap = [bodies[k] for k in range(model.nmocap)]

    def state(self) -> tuple[Array, Array]:
        qpos = self.scene.qpos(self.world.q)
        return qpos, np.linalg.solve(self.scene.velocity_map(qpos), self.world.v)

    def set_mocap(self, position: Array, wxyz: Array) -> None:
        for name, at, turned in zip(self.mocap, position, wxyz, strict=True):
            self.world.set_mocap(name, at, turned[XYZW] / np.linalg.norm(turned))

    def step(self, ctrl: Array) -> None:
        self.world.ctrl = ctrl[self.command]
        self.world.step()


class Servo:
    """The recorded commands, and for motors a torque that holds their joints to the recorded motion.

    Torques alone do not carry an arm far: an error of a moment's contact grows for seconds. So a motor is commanded
    u + M (stiffness (q_r - q) + 2 sqrt(stiffness) (v_r - v)), with the recorded command u, positions q_r, velocities v_r,
    and the inertia M (of the motors' joints) at q_r; in both programs the same, and nothing but u on the recorded path.
    """

    def __init__(self, scene: Scene, recording: Recording, frequency: float) -> None:
        """frequency: of the undamped servo [rad/s]; 0 for none."""
        model = scene.mujoco
        direct = (model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)) & (
            model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_NONE)
        )
        self.motors = np.flatnonzero(direct) if frequency > 0 else np.zeros(0, int)
        joints = model.actuator_trnid[self.motors, 0]
        self.iq, self.iv = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self.gear = model.actuator_gear[self.motors, 0] * model.actuator_gainprm[self.motors, 0]
        self.range = model.actuator_ctrlrange[self.motors].T
        self.scene, self.recording, self.frequency = scene, recording, frequency

    def ctrl(self, k: int, program: Program) -> Array:
        """Commands (nu) of step k."""
        recording = self.recording
        ctrl = recording.ctrl[k].copy()
        if len(self.motors):
            qpos, qvel = program.state()
            e = (recording.qpos[k] - qpos)[self.iq]
            de = (recording.qvel[k] - qvel)[self.iv]
            force = self.inertia(recording.qpos[k]) @ (self.frequency**2 * e + 2 * self.frequency * de)
            ctrl[self.motors] = np.clip(ctrl[self.motors] + force / self.gear, *self.range)
        return ctrl

    def inertia(self, qpos: Array) -> Array:
        """Of the motors' joints (n, n)."""
        model, data = self.scene.mujoco, self.scene.data
        data.qpos = qpos
        mujoco.mj_fwdPosition(model, data)
        M = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        return M[np.ix_(self.iv, self.iv)]


def replay(recording: Recording, program: Program, servo: Servo) -> Array:
    """qpos (n + 1, nq)."""
    states = [program.state()[0]]
    for k in range(len(recording.ctrl)):
        program.set_mocap(recording.mocap_pos[k], recording.mocap_quat[k])
        program.step(servo.ctrl(k, program))
        states.append(program.state()[0])
    return np.array(states)
