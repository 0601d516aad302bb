"""Joint motors beside the real PyBullet's: the Panda in the air, the same inertias, one second of motion.

PyBullet's solver sweeps over the motors one by one, 50 times by default; ours solves them together. So PyBullet is
given enough sweeps to converge, and how far its default is from that is printed.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh

pb = pytest.importorskip("pybullet")
bullet_client = pytest.importorskip("pybullet_utils.bullet_client")

Array = NDArray[np.float64]
TIME_STEP = 0.002
STEPS = 500
CONVERGED = 2000  # sweeps
TOLERANCE = 1e-8  # [rad, m] of the 1e-11 that sweeping until it converges leaves
NEUTRAL = np.array([0, 0.41, 0, -1.85, 0, 2.26, 0.79, 0.02, 0.02])
PANDA_FORCES = np.array([87, 87, 87, 87, 12, 120, 120, 170, 170.0])
URDF = Path(mh.asset_path("panda/panda.urdf"))


@dataclass
class Trial:
    """Targets that change four times in a second, and the motors' strength."""

    targets: Array  # (4, 9) [rad, m]
    forces: Array  # (9) [N m, N]
    kp: float = 0.1
    kd: float = 1.0

    def target(self, step: int) -> Array:
        return self.targets[step * len(self.targets) // STEPS]


def trial(seed: int, span: float, forces: Array) -> Trial:
    rng = np.random.default_rng(seed)
    targets = NEUTRAL + span * rng.uniform(-1, 1, (4, 9))
    targets[:, 7:] = rng.uniform(0.005, 0.035, (4, 2))
    return Trial(targets, forces)


@contextmanager
def bullet_panda(iterations: int) -> Iterator[tuple[object, int, list[int]]]:
    client = bullet_client.BulletClient(pb.DIRECT)
    try:
        client.setGravity(0, 0, -9.81)
        client.setTimeStep(TIME_STEP)
        client.setPhysicsEngineParameter(numSolverIterations=iterations, solverResidualThreshold=0)
        body = client.loadURDF(str(URDF), useFixedBase=True, flags=pb.URDF_USE_INERTIA_FROM_FILE)
        client.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
        kinds = [client.getJointInfo(body, i)[2] for i in range(client.getNumJoints(body))]
        yield client, body, [i for i, kind in enumerate(kinds) if kind != pb.JOINT_FIXED]
    finally:
        client.disconnect()


def bullet_path(one: Trial, iterations: int) -> tuple[Array, Array]:
    """Joint positions after each step (STEPS, 9) and the motor forces that made it."""
    with bullet_panda(iterations) as (client, body, joints):
        for joint, q in zip(joints, NEUTRAL, strict=True):
            client.resetJointState(body, joint, q)
        path, forces = [], []
        for step in range(STEPS):
            client.setJointMotorControlArray(
                body,
                joints,
                pb.POSITION_CONTROL,
                targetPositions=one.target(step),
                forces=one.forces,
                positionGains=[one.kp] * 9,
                velocityGains=[one.kd] * 9,
            )
            client.stepSimulation()
            states = client.getJointStates(body, joints)
            path.append([state[0] for state in states])
            forces.append([state[3] for state in states])
        return np.array(path), np.array(forces)


def uncoupled_panda() -> mh.Model:
    """The Panda without the mimic joint of its fingers, which PyBullet does not read."""
    lines = [line for line in URDF.read_text().splitlines() if "<mimic" not in line]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "panda.urdf"
        path.write_text("\n".join(lines))
        return mh.load_urdf(path, load_meshes=False)[0]


def our_path(one: Trial) -> Array:
    model = uncoupled_panda()
    world = mh.World(model, time_step=TIME_STEP)
    world.q = NEUTRAL
    path = []
    for step in range(STEPS):
        world.set_motors(target_q=one.target(step), kp=one.kp, kd=one.kd, max_force=one.forces)
        world.step()
        path.append(world.q)
    return np.array(path)


def show(capsys: pytest.CaptureFixture[str], what: str, one: Trial, ours: Array, converged: Array) -> None:
    by_default, _ = bullet_path(one, 50)
    with capsys.disabled():
        print(
            f"\n  {what}: ours from PyBullet converged {np.abs(ours - converged).max():.1e} rad; "
            f"PyBullet's default (50 sweeps) from it {np.abs(by_default - converged).max():.1e} rad",
            end="",
        )


@pytest.mark.parametrize("seed", range(4))
def test_strong_motors(seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    one = trial(seed, 0.5, np.full(9, 1e5))
    theirs, forces = bullet_path(one, CONVERGED)
    assert (np.abs(forces) < 0.99 * one.forces).all(), "a motor saturates: this trial belongs to the other test"
    ours = our_path(one)
    show(capsys, f"strong motors, seed {seed}", one, ours, theirs)
    assert np.abs(ours[-1] - NEUTRAL).max() > 0.1
    np.testing.assert_allclose(ours, theirs, atol=TOLERANCE)


@pytest.mark.parametrize("seed", range(4))
def test_saturating_motors(seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    one = trial(seed, 0.5, PANDA_FORCES)
    theirs, forces = bullet_path(one, CONVERGED)
    assert (np.abs(forces) >= 0.999 * one.forces).any(axis=1).sum() > 10, "hardly a motor saturates"
    ours = our_path(one)
    show(capsys, f"the Panda's motors, seed {seed}", one, ours, theirs)
    np.testing.assert_allclose(ours, theirs, atol=TOLERANCE)


# Stiffer ones would meet the cap of 100 rad/s that PyBullet puts on joints.
@pytest.mark.parametrize(("kp", "kd"), [(0.02, 1.0), (0.1, 0.3), (0.2, 0.8)])
def test_other_gains(kp: float, kd: float, capsys: pytest.CaptureFixture[str]) -> None:
    one = trial(9, 0.3, np.full(9, 1e5))
    one.kp, one.kd = kp, kd
    theirs, _ = bullet_path(one, CONVERGED)
    ours = our_path(one)
    show(capsys, f"kp {kp}, kd {kd}", one, ours, theirs)
    np.testing.assert_allclose(ours, theirs, atol=TOLERANCE)


def test_limp_arm_falls_alike() -> None:
    one = trial(0, 0.0, np.zeros(9))
    theirs, _ = bullet_path(one, CONVERGED)
    np.testing.assert_allclose(our_path(one)[:100], theirs[:100], atol=TOLERANCE)
