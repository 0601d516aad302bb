"""`python -m benchmarks.bullet speed`: frequent calls here and on PyBullet, in one run and one thread.

A Panda holds its posture above a plane, a cube lies beside it. Of five rounds the fastest counts; the two modules take
turns. The scenes end in the same place, or a ratio is not shown.
"""

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType

import numpy as np

from benchmarks.report import machine
from manyhands.files import write_text

ROUNDS = 5
HOME = [0, 0.41, 0, -1.85, 0, 2.26, 0.79]
JOINTS = list(range(7))
TARGET, DOWN = [0.5, 0.1, 0.4], [1, 0, 0, 0]
OUTPUT = Path("build/bullet_speed.json")
Call = Callable[[ModuleType], object]


def scene(p: ModuleType) -> None:
    """The same in both modules."""
    import pybullet_data

    p.connect(p.DIRECT)
    p.setAdditionalSearchPath(pybullet_data.getDataPath())
    p.setGravity(0, 0, -9.81)
    p.loadURDF("plane.urdf")
    p.loadURDF("franka_panda/panda.urdf", useFixedBase=True)
    p.loadURDF("cube_small.urdf", [0.5, 0, 0.05])
    for joint, q in enumerate(HOME):
        p.resetJointState(1, joint, q)
    p.setJointMotorControlArray(1, JOINTS, p.POSITION_CONTROL, targetPositions=HOME, forces=[87] * 7)
    for _ in range(240):
        p.stepSimulation()


def calls() -> dict[str, tuple[Call, int]]:
    """What is timed, and how often in a round."""
    rng = np.random.default_rng(0)
    begins = rng.uniform(-1, 1, (1000, 3)).tolist()
    ends = [[x, y, -1] for x, y, _ in begins]
    forces, view, projection = [87.0] * 7, [1.0, 1, 1], (60, 1, 0.1, 10)

    def picture(p: ModuleType) -> object:
        return p.getCameraImage(
            84, 84, p.computeViewMatrix(view, [0, 0, 0], [0, 0, 1]), p.computeProjectionMatrixFOV(*projection),
            renderer=p.ER_TINY_RENDERER,
        )  # fmt: skip

    return {
        "stepSimulation": (lambda p: p.stepSimulation(), 500),
        "calculateInverseKinematics": (lambda p: p.calculateInverseKinematics(1, 11, TARGET, DOWN), 500),
        "getLinkState": (lambda p: p.getLinkState(1, 11), 5000),
        "getLinkState, with velocity": (lambda p: p.getLinkState(1, 11, 1), 5000),
        "getJointStates": (lambda p: p.getJointStates(1, JOINTS), 5000),
        "setJointMotorControl2": (
            lambda p: p.setJointMotorControl2(1, 3, p.POSITION_CONTROL, targetPosition=HOME[3], force=87), 5000,
        ),
        "setJointMotorControlArray": (
            lambda p: p.setJointMotorControlArray(1, JOINTS, 2, targetPositions=HOME, forces=forces), 5000,
        ),
        "getContactPoints": (lambda p: p.getContactPoints(2), 5000),
        "getBasePositionAndOrientation": (lambda p: p.getBasePositionAndOrientation(2), 5000),
        "rayTestBatch, 1000 rays": (lambda p: p.rayTestBatch(begins, ends), 20),
        "getCameraImage, 84 x 84": (picture, 10),
        "getNumJoints": (lambda p: p.getNumJoints(1), 5000),
        "isConnected": (lambda p: p.isConnected(), 5000),
    }  # fmt: skip


def seconds(call: Call, p: ModuleType, count: int) -> float:
    """Of one call, the mean of a round."""
    start = time.perf_counter()
    for _ in range(count):
        call(p)
    return (time.perf_counter() - start) / count


def main(_: Sequence[str] = ()) -> int:
    """Prints and writes the table; the exit status is 1 if the scenes are not the same."""
    import pybullet

    import manyhands.pybullet

    modules = (manyhands.pybullet, pybullet)
    for module in modules:
        scene(module)
    cubes = [module.getBasePositionAndOrientation(2)[0] for module in modules]
    if not np.allclose(*cubes, atol=2e-3):
        print(f"The cube lies at {cubes[0]} here and at {cubes[1]} in PyBullet: nothing is compared.")
        return 1
    rows = []
    for name, (call, count) in calls().items():
        ours, theirs = (
            min(times)
            for times in zip(*([seconds(call, p, count) for p in modules] for _ in range(ROUNDS)), strict=True)
        )
        rows.append({"call": name, "here": ours, "pybullet": theirs})
        print(f"{name:32} {1e6 * ours:9.2f} us {1e6 * theirs:9.2f} us   x{theirs / ours:.1f}")
    write_text(OUTPUT, json.dumps(machine() | {"calls": rows}, indent=1) + "\n")
    print(f"Written: {OUTPUT}")
    return 0
