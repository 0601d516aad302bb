"""The same poses by other programs, each of which is judged by our forward kinematics in double precision.

All begin at the same configuration and, where that does not lead to the goal, at random ones within the limits, up to
`ATTEMPTS` times. TRAC-IK restarts by itself, until its time is over.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.ik.arms import TOLERANCE, Arm, Array, Poses, solved
from manyhands import kinematics as kin

ATTEMPTS = 20
_STEPS = 50  # of Pink and mink in an attempt
_TIME = 0.05  # [s] that TRAC-IK has for a pose
_HALF = TOLERANCE / 2  # what is asked, so that rounding does no harm

Solver = Callable[[Array, Array, Array], Array]
"""From start (nq,), position and quaternion to the q (nq,) that a single attempt finds."""


@dataclass(frozen=True)
class Beside:
    """What a program did with an arm's poses."""

    program: str
    poses: int
    solved: int
    rate: float
    """solutions a second of processor time, threads counted together"""
    single: float
    """[s] median on the clock for a pose, restarts included"""


def _tried(name: str, make: Callable[[Arm], Solver], arm: Arm) -> Solver | str:
    try:
        return make(arm)
    except ImportError as error:
        return f"{name}: not installed ({error.name})"


def beside(arm: Arm, poses: Poses, advance: Callable[[], None]) -> Iterator[Beside | str]:
    """Results of every program; a sentence for each that is not installed. `advance` is called after every pose."""
    for name, make, attempts in PROGRAMS:
        solver = _tried(name, make, arm)
        if isinstance(solver, str):
            for _ in poses.q:
                advance()
            yield solver
        else:
            yield _run(name, arm, poses, solver, attempts, advance)


def _run(name: str, arm: Arm, poses: Poses, solver: Solver, attempts: int, advance: Callable[[], None]) -> Beside:
    random = np.random.default_rng(0)
    first = np.clip(arm.model.neutral_configuration(), *arm.limits)
    count, processor, clock = 0, 0.0, []
    for i in range(len(poses.q)):
        one = Poses(*(rows[i, None] for rows in (poses.q, poses.position, poses.quaternion)))
        starts = [first, *random.uniform(*arm.limits, (attempts - 1, len(first)))]
        before = time.process_time(), time.perf_counter()
        paused = [0.0, 0.0]
        reached = False
        for start in starts:
            q = solver(start, one.position[0], one.quaternion[0])
            judged = time.process_time(), time.perf_counter()
            reached = bool(solved(arm, one, q[None])[0])
            paused[0] += time.process_time() - judged[0]
            paused[1] += time.perf_counter() - judged[1]
            if reached:
                break
        processor += time.process_time() - before[0] - paused[0]
        clock.append(time.perf_counter() - before[1] - paused[1])
        count += reached
        advance()
    return Beside(name, len(poses.q), count, count / processor, float(np.median(clock)))


def _ours(arm: Arm) -> Solver:
    def solve(start: Array, position: Array, quaternion: Array) -> Array:
        found = kin.inverse(
            arm.model,
            arm.frame,
            position=position,
            quaternion=quaternion,
            start=start,
            position_tolerance=TOLERANCE,
            rotation_tolerance=TOLERANCE,
        )
        return found.q

    return solve


def _pybullet(arm: Arm) -> Solver:
    """Without limits, which it takes as a wish in the null space: with them it does not come as near."""
    p: Any = import_module("pybullet")
    client = p.connect(p.DIRECT)
    robot = p.loadURDF(str(arm.path), useFixedBase=True, physicsClientId=client)
    infos = [p.getJointInfo(robot, j, physicsClientId=client) for j in range(p.getNumJoints(robot, client))]
    moving = [info[0] for info in infos if info[2] != p.JOINT_FIXED]
    link = next(info[0] for info in infos if info[12].decode() == arm.frame)

    def solve(start: Array, position: Array, quaternion: Array) -> Array:
        for joint, value in zip(moving, start.tolist(), strict=True):
            p.resetJointState(robot, joint, value, physicsClientId=client)
        return np.array(
            p.calculateInverseKinematics(
                robot,
                link,
                position.tolist(),
                quaternion.tolist(),
                maxNumIterations=1000,
                residualThreshold=1e-10,
                physicsClientId=client,
            )
        )

    return solve


def _trac_ik(arm: Arm) -> Solver:
    trac_ik: Any = import_module("trac_ik")
    root = next(link.name for link in arm.model.links if link.name != "world")
    solver = trac_ik.TracIK(root, arm.frame, str(arm.path), timeout=_TIME, epsilon=_HALF)
    dofs = solver.dof  # of the chain, which come first in q

    def solve(start: Array, position: Array, quaternion: Array) -> Array:
        rotation = kin.matrix(position, quaternion)[:3, :3]
        found = solver.ik(position, rotation, start[:dofs])
        return start if found is None else np.concatenate([found, start[dofs:]])

    return solve


def _pink(arm: Arm) -> Solver:
    pin: Any = import_module("pinocchio")
    pink: Any = import_module("pink")
    import_module("daqp")
    model = pin.buildModelFromUrdf(str(arm.path))
    data = model.createData()
    task = pink.FrameTask(arm.frame, position_cost=1.0, orientation_cost=1.0, lm_damping=1e-6)
    limits = [pink.limits.ConfigurationLimit(model, config_limit_gain=1.0)]

    def solve(start: Array, position: Array, quaternion: Array) -> Array:
        configuration = pink.Configuration(model, data, start.copy())
        task.set_target(pin.XYZQUATToSE3(np.concatenate([position, quaternion])))
        for _ in range(_STEPS):
            v = pink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=limits, safety_break=False)
            configuration.integrate_inplace(v, 1.0)
            if np.linalg.norm(task.compute_error(configuration)) < _HALF:
                break
        return configuration.q

    return solve


def _mink(arm: Arm) -> Solver:
    mujoco: Any = import_module("mujoco")
    mink: Any = import_module("mink")
    import_module("daqp")
    spec = mujoco.MjSpec.from_file(str(arm.path))
    spec.compiler.fusestatic = False
    model = spec.compile()
    task = mink.FrameTask(arm.frame, "body", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-6)
    limits = [mink.ConfigurationLimit(model, gain=1.0)]
    configuration = mink.Configuration(model)

    def solve(start: Array, position: Array, quaternion: Array) -> Array:
        configuration.update(start)
        task.set_target(mink.SE3(np.concatenate([np.roll(quaternion, 1), position])))
        for _ in range(_STEPS):
            v = mink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=limits)
            configuration.integrate_inplace(v, 1.0)
            if np.linalg.norm(task.compute_error(configuration)) < _HALF:
                break
        return configuration.q.copy()

    return solve


PROGRAMS: tuple[tuple[str, Callable[[Arm], Solver], int], ...] = (
    ("manyhands, one call a pose", _ours, 1),
    ("TRAC-IK", _trac_ik, 1),
    ("PyBullet", _pybullet, ATTEMPTS),
    ("PyBullet, one attempt", _pybullet, 1),
    ("Pink", _pink, ATTEMPTS),
    ("mink", _mink, ATTEMPTS),
)
