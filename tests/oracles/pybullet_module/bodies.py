"""What tests of several subjects make bodies of."""

import numpy as np

from benchmarks.bullet.beside import Beside

ARM = "kuka_iiwa/model.urdf"
DOFS = range(7)


def place(rng: np.random.Generator, reach: float = 1.0) -> tuple[list[float], list[float]]:
    """A random position [m] and quaternion."""
    r = rng.normal(size=4)
    return rng.uniform(-reach, reach, 3).tolist(), (r / np.linalg.norm(r)).tolist()


def pose(rng: np.random.Generator) -> list[float]:
    """Random angles for the arm, inside its limits."""
    return rng.uniform(-1.2, 1.2, 7).tolist()


def add_arm(both: Beside, rng: np.random.Generator, **options: object) -> int:
    """The arm on a fixed base, in a random pose, under gravity."""
    both.setGravity(0, 0, -9.81)
    arm = both.loadURDF(ARM, useFixedBase=True, **options)
    for joint, q in enumerate(pose(rng)):
        both.resetJointState(arm, joint, q)
    return arm


def set_free(both: Beside, body: int, joints: range) -> None:
    """Without motors, and without damping, which is explicit there and implicit here."""
    both.setJointMotorControlArray(body, joints, both.VELOCITY_CONTROL, forces=[0] * len(joints))
    for link in range(-1, both.getNumJoints(body)):
        both.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0)


def solve_to_the_end(both: Beside) -> None:
    """The real module's sweeps go on until they converge."""
    both.setPhysicsEngineParameter(numSolverIterations=2000, solverResidualThreshold=0)


def add_box(both: Beside, position: list[float], half: float = 0.1, mass: float = 1.0) -> int:
    """A cube of that half extent [m]."""
    return both.createMultiBody(mass, both.createCollisionShape(both.GEOM_BOX, halfExtents=[half] * 3), -1, position)


def random_chain(both: Beside, rng: np.random.Generator, links: int, **options: object) -> int:
    """A free body with a tree of links on it, all of createMultiBody's lists in use."""
    shapes = [
        both.createCollisionShape(both.GEOM_BOX, halfExtents=rng.uniform(0.05, 0.2, 3).tolist()),
        both.createCollisionShape(both.GEOM_SPHERE, radius=rng.uniform(0.05, 0.2)),
        both.createCollisionShape(both.GEOM_CYLINDER, radius=rng.uniform(0.05, 0.2), height=rng.uniform(0.1, 0.4)),
        both.createCollisionShape(both.GEOM_CAPSULE, radius=rng.uniform(0.05, 0.2), height=rng.uniform(0.1, 0.4)),
    ]
    seen = both.createVisualShape(both.GEOM_BOX, halfExtents=[0.1, 0.2, 0.3], rgbaColor=[0.1, 0.2, 0.3, 1])
    kinds = [both.JOINT_REVOLUTE, both.JOINT_PRISMATIC, both.JOINT_FIXED]
    frames, inertial = [place(rng, 0.4) for _ in range(links)], [place(rng, 0.05) for _ in range(links)]
    base, own = place(rng), place(rng, 0.05)
    return both.createMultiBody(
        baseMass=rng.uniform(0.5, 3),
        baseCollisionShapeIndex=shapes[0],
        baseVisualShapeIndex=seen,
        basePosition=base[0],
        baseOrientation=base[1],
        baseInertialFramePosition=own[0],
        baseInertialFrameOrientation=own[1],
        linkMasses=rng.uniform(0.2, 2, links).tolist(),
        linkCollisionShapeIndices=[shapes[i] for i in rng.integers(4, size=links)],
        linkVisualShapeIndices=[seen if rng.integers(2) else -1 for _ in range(links)],
        linkPositions=[frame[0] for frame in frames],
        linkOrientations=[frame[1] for frame in frames],
        linkInertialFramePositions=[frame[0] for frame in inertial],
        linkInertialFrameOrientations=[frame[1] for frame in inertial],
        linkParentIndices=[int(rng.integers(i + 1)) for i in range(links)],
        linkJointTypes=[kinds[i] for i in rng.integers(3, size=links)],
        linkJointAxis=[[[1, 0, 0], [0, 1, 0], [0, 0, 1]][i] for i in rng.integers(3, size=links)],
        **options,
    )
