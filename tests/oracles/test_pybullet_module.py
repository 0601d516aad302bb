"""manyhands.pybullet beside the real module: the same calls, the same numbers within what is stated here.

Known differences, which these tests leave out: the real module's single-precision results (1e-6), its iterations that
end before motors and contacts are exact, its explicit joint damping, which blows up on light links, and the sign of
quaternions.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import manyhands.pybullet as ours

real = pytest.importorskip("pybullet")
pybullet_data = pytest.importorskip("pybullet_data")

PATH = pybullet_data.getDataPath()
FILES = [
    "kuka_iiwa/model.urdf",
    "franka_panda/panda.urdf",
    "cube_small.urdf",
    "sphere2.urdf",
    "table/table.urdf",
    "cartpole.urdf",
]
Q = [0.1, 0.5, -0.2, -1.0, 0.3, 0.8, 0.2]
MODULES = (ours, real)


@pytest.fixture(autouse=True)
def clients() -> Iterator[None]:
    for module in MODULES:
        assert module.connect(module.DIRECT) == 0
        module.setAdditionalSearchPath(PATH)
    yield
    for module in MODULES:
        module.disconnect()


def both(call: Callable[[Any], Any]) -> tuple[Any, Any]:
    return call(ours), call(real)


def assert_alike(a: Any, b: Any, tolerance: float, where: str = "") -> None:
    """Types and lengths exactly, numbers within the tolerance, quaternions up to their sign."""
    assert type(a) is type(b), f"{where}: {a!r} beside {b!r}"
    if isinstance(a, tuple):
        assert len(a) == len(b), f"{where}: {a!r} beside {b!r}"
        numbers = len(a) == 4 and all(isinstance(x, float) for x in a)
        if numbers and abs(sum(x * x for x in a) - 1) < 1e-6 and sum(x * y for x, y in zip(a, b, strict=True)) < 0:
            a = tuple(-x for x in a)
        for i, (x, y) in enumerate(zip(a, b, strict=True)):
            assert_alike(x, y, tolerance, f"{where}[{i}]")
    elif isinstance(a, float):
        assert abs(a - b) <= tolerance * max(1, abs(b)), f"{where}: {a} beside {b}"
    else:
        assert a == b, where


def alike(call: Callable[[Any], Any], tolerance: float = 2e-6) -> None:
    assert_alike(*both(call), tolerance)


def test_constants_have_the_same_values() -> None:
    for name, value in vars(real).items():
        if isinstance(value, int):
            assert getattr(ours, name) == value, name


def test_every_function_is_there() -> None:
    missing = {n for n, f in vars(real).items() if callable(f) and not n.startswith("_") and not hasattr(ours, n)}
    assert missing <= {"loadSDF"}


@pytest.mark.parametrize("file", FILES)
def test_a_file_loads_as_the_same_body(file: str) -> None:
    place = ([0.1, 0.2, 0.3], [0, 0, math.sin(0.2), math.cos(0.2)])
    alike(lambda m: m.loadURDF(file, *place))
    alike(lambda m: m.getBodyInfo(0))
    alike(lambda m: m.getNumJoints(0))
    alike(lambda m: m.computeDofCount(0))
    alike(lambda m: m.getBasePositionAndOrientation(0), 1e-5)
    for joint in range(real.getNumJoints(0)):
        alike(lambda m, j=joint: m.getJointInfo(0, j), 1e-5)
        alike(lambda m, j=joint: m.getLinkState(0, j, computeLinkVelocity=1), 1e-5)
        alike(lambda m, j=joint: m.getJointState(0, j), 1e-5)


@pytest.mark.parametrize("file", ["kuka_iiwa/model.urdf", "cube_small.urdf", "sphere2.urdf", "cartpole.urdf"])
def test_inertias_come_from_shapes(file: str) -> None:
    for module in MODULES:
        module.loadURDF(file)
    for link in range(-1, real.getNumJoints(0)):
        alike(lambda m, k=link: m.getDynamicsInfo(0, k), 1e-4)


def test_inertias_come_from_the_file_where_a_flag_says_so() -> None:
    for module in MODULES:
        module.loadURDF("kuka_iiwa/model.urdf", flags=module.URDF_USE_INERTIA_FROM_FILE)
    for link in range(real.getNumJoints(0)):
        alike(lambda m, k=link: m.getDynamicsInfo(0, k), 1e-4)


def arm(module: Any) -> None:
    module.setGravity(0, 0, -9.81)
    module.loadURDF("kuka_iiwa/model.urdf", useFixedBase=True)
    for joint, q in enumerate(Q):
        module.resetJointState(0, joint, q)


def off(module: Any) -> None:
    """Without motors, and without damping, which differs: implicit here, explicit there."""
    arm(module)
    module.setJointMotorControlArray(0, range(7), module.VELOCITY_CONTROL, forces=[0] * 7)
    for link in range(-1, 7):
        module.changeDynamics(0, link, linearDamping=0, angularDamping=0, jointDamping=0)


def positions(module: Any) -> None:
    off(module)
    module.setJointMotorControlArray(0, range(7), module.POSITION_CONTROL, targetPositions=[0.3] * 7, forces=[3000] * 7)


def gains(module: Any) -> None:
    off(module)
    module.setJointMotorControlArray(
        0,
        range(7),
        module.POSITION_CONTROL,
        targetPositions=[0.3] * 7,
        forces=[3000] * 7,
        positionGains=[0.03] * 7,
        velocityGains=[0.5] * 7,
    )


def speeds(module: Any) -> None:
    off(module)
    module.setJointMotorControlArray(
        0, range(7), module.VELOCITY_CONTROL, targetVelocities=[0.5] * 7, forces=[3000] * 7
    )


def speed_limits(module: Any) -> None:
    off(module)
    for joint in range(7):
        module.setJointMotorControl2(0, joint, module.POSITION_CONTROL, targetPosition=1, force=3000, maxVelocity=0.4)


def nothing(module: Any) -> None: ...


def torques(module: Any) -> None:
    module.setJointMotorControlArray(0, range(7), module.TORQUE_CONTROL, forces=[5, -3, 2, 4, 1, 0.05, 0.01])


def pushes(module: Any) -> None:
    module.applyExternalForce(0, 3, [5, 2, 10], [0.01, 0, 0], module.LINK_FRAME)
    module.applyExternalTorque(0, 3, [0, 1, 2], module.WORLD_FRAME)
    module.applyExternalForce(0, 4, [1, 0, 3], module.getLinkState(0, 4)[0], module.WORLD_FRAME)


@pytest.mark.parametrize(
    ("prepare", "act", "tolerance"),
    [
        (off, nothing, 1e-6),
        (off, torques, 1e-5),
        (off, pushes, 1e-4),
        (positions, nothing, 1e-4),
        (gains, nothing, 1e-4),
        (speeds, nothing, 1e-4),
        (speed_limits, nothing, 1e-4),
    ],
)
def test_motors_in_the_air(prepare: Callable[[Any], None], act: Callable[[Any], None], tolerance: float) -> None:
    for module in MODULES:
        module.setPhysicsEngineParameter(numSolverIterations=2000, solverResidualThreshold=0)
        prepare(module)
    for _ in range(24):
        for module in MODULES:
            act(module)
            module.stepSimulation()
        states = [np.array([s[0] for s in m.getJointStates(0, range(7))]) for m in MODULES]
        assert np.abs(states[0] - states[1]).max() < tolerance


def test_dynamics_of_an_arm() -> None:
    for module in MODULES:
        arm(module)
    q, v, a = [0.1, 0.2, 0.3, -0.4, 0.5, 0.6, 0.7], [0.3] * 7, [0.2] * 7
    alike(lambda m: m.calculateMassMatrix(0, q), 1e-5)
    alike(lambda m: m.calculateInverseDynamics(0, q, v, a), 1e-6)
    alike(lambda m: m.calculateJacobian(0, 6, [0.01, 0.02, 0.03], q, v, a), 1e-6)


def test_dynamics_of_a_free_body() -> None:
    for module in MODULES:
        module.setGravity(0, 0, -9.81)
        module.loadURDF("cartpole.urdf")
        module.resetSimulation()
        module.loadURDF("r2d2.urdf", flags=module.URDF_USE_INERTIA_FROM_FILE)
    n = real.computeDofCount(0)
    q = [0.05 * i for i in range(n)]
    assert np.shape(ours.calculateMassMatrix(0, q)) == np.shape(real.calculateMassMatrix(0, q)) == (n + 6, n + 6)


@pytest.mark.parametrize("iterations", [1, 5, 20])
@pytest.mark.parametrize("orientation", [None, [0, 1, 0, 0]])
def test_inverse_kinematics_takes_the_same_steps(iterations: int, orientation: list[float] | None) -> None:
    for module in MODULES:
        arm(module)
    target = ([0.5, 0.1, 0.6],) if orientation is None else ([0.5, 0.1, 0.6], orientation)
    alike(lambda m: m.calculateInverseKinematics(0, 6, *target, maxNumIterations=iterations), 1e-7)
    alike(
        lambda m: m.calculateInverseKinematics(0, 6, *target, jointDamping=[0.1] * 7, maxNumIterations=iterations), 1e-7
    )
    near = {
        "lowerLimits": [-2.9, -2, -2.9, -2, -2.9, -2, -3],
        "upperLimits": [2.9, 2, 2.9, 2, 2.9, 2, 3],
        "jointRanges": [5.8, 4, 5.8, 4, 5.8, 4, 6],
        "restPoses": [0, 0, 0, 0.5 * math.pi, 0, -math.pi * 0.5 * 0.66, 0],
    }
    alike(lambda m: m.calculateInverseKinematics(0, 6, *target, **near, maxNumIterations=iterations), 1e-5)


def scene(module: Any) -> None:
    module.setGravity(0, 0, -9.81)
    module.loadURDF("plane.urdf")
    for shape, x in (
        (module.createCollisionShape(module.GEOM_BOX, halfExtents=[0.1] * 3), 0),
        (module.createCollisionShape(module.GEOM_SPHERE, radius=0.1), 0.5),
        (module.createCollisionShape(module.GEOM_CYLINDER, radius=0.1, height=0.2), 1),
    ):
        module.createMultiBody(1, shape, -1, [x, 0, 0.11])


def test_things_come_to_rest_in_the_same_place() -> None:
    for module in MODULES:
        scene(module)
        for _ in range(240):
            module.stepSimulation()
    for body in (1, 2, 3):
        alike(lambda m, b=body: m.getBasePositionAndOrientation(b), 1e-3)
        alike(lambda m, b=body: m.getAABB(b), 2e-3)
        weights = [sum(contact[9] for contact in m.getContactPoints(body)) for m in MODULES]
        assert weights[0] == pytest.approx(9.81, rel=1e-6) and weights[1] == pytest.approx(9.81, rel=1e-3)
    alike(lambda m: m.rayTest([0, 0, 1], [0, 0, 0]), 1e-3)
    alike(lambda m: m.rayTestBatch([[0.5, 0.03, 1], [0, 0.5, 1]], [[0.5, 0.03, 0], [0, 0.5, 0.5]]), 1e-3)
    alike(lambda m: m.getClosestPoints(1, 2, 1), 1e-3)
    alike(lambda m: m.getClosestPoints(1, 2, 0.1))
    assert set(ours.getOverlappingObjects([-0.2, -0.2, 0.05], [0.2, 0.2, 0.2])) >= {(1, -1)}


def test_a_thing_slides_as_far() -> None:
    for module in MODULES:
        scene(module)
        for _ in range(60):
            module.stepSimulation()
        module.resetBaseVelocity(1, [2, 0, 0])
        for _ in range(60):
            module.stepSimulation()
    alike(lambda m: m.getBasePositionAndOrientation(1)[0], 2e-3)
    alike(lambda m: m.getBaseVelocity(1)[0], 1e-2)
    contact = [m.getContactPoints(1)[0] for m in MODULES]
    for index in (1, 2, 3, 4, 7):
        assert_alike(contact[0][index], contact[1][index], 1e-3)
    friction = [
        np.sum([np.multiply(c[10], c[11]) + np.multiply(c[12], c[13]) for c in m.getContactPoints(1, 0)], 0)
        for m in MODULES
    ]
    assert friction[0] == pytest.approx(friction[1], abs=0.3)


def test_constraints_pull_as_slowly() -> None:
    for module in MODULES:
        module.createMultiBody(1, module.createCollisionShape(module.GEOM_BOX, halfExtents=[0.1] * 3), -1, [0, 0, 1])
        weld = module.createConstraint(0, -1, -1, -1, module.JOINT_FIXED, [0, 0, 0], [0, 0, 0], [0.02, 0, 1])
        assert weld == 1
    for _ in range(30):
        for module in MODULES:
            module.stepSimulation()
        alike(lambda m: m.getBasePositionAndOrientation(0)[0], 1e-3)
    alike(lambda m: m.getConstraintInfo(1))
    alike(lambda m: m.getNumConstraints())
    for module in MODULES:
        module.removeConstraint(1)
    alike(lambda m: m.getNumConstraints())


def test_mathematics() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        a, b = (tuple(x / np.linalg.norm(x)) for x in rng.normal(size=(2, 4)))
        u, v = (tuple(x) for x in rng.normal(size=(2, 3)))
        alike(lambda m, u=u: m.getQuaternionFromEuler(u))
        alike(lambda m, a=a: m.getEulerFromQuaternion(a))
        alike(lambda m, a=a: m.getMatrixFromQuaternion(a))
        alike(lambda m, a=a, b=b, u=u, v=v: m.multiplyTransforms(u, a, v, b))
        alike(lambda m, a=a, u=u: m.invertTransform(u, a))
        alike(lambda m, a=a, u=u: m.rotateVector(a, u))
        alike(lambda m, u=u: m.getQuaternionFromAxisAngle(u, 0.7))
        alike(lambda m, a=a: m.getAxisAngleFromQuaternion(a))
        alike(lambda m, a=a, b=b: m.getDifferenceQuaternion(a, b))
        alike(lambda m, a=a, b=b: m.getQuaternionSlerp(a, b, 0.3))
        alike(lambda m, a=a, b=b: m.calculateVelocityQuaternion(a, b, 0.1), 1e-4)
        alike(lambda m, u=u, v=v: m.computeViewMatrix(u, v, [0, 0, 1]), 1e-5)
        alike(lambda m, u=u: m.computeViewMatrixFromYawPitchRoll(u, 2, 30, -40, 0, 2), 1e-5)
        alike(lambda m, u=u: m.computeViewMatrixFromYawPitchRoll(u, 2, 30, -40, 20, 2), 1e-5)
        alike(lambda m, u=u: m.computeViewMatrixFromYawPitchRoll(u, 2, 30, -40, 0, 1), 1e-5)
    alike(lambda m: m.computeProjectionMatrix(-1, 2, -1, 1.5, 0.1, 10))
    alike(lambda m: m.computeProjectionMatrixFOV(60, 1.5, 0.1, 10))


@pytest.mark.parametrize(
    "call",
    [
        lambda m: m.getNumJoints(9),
        lambda m: m.getContactPoints(9),
        lambda m: m.getClosestPoints(0, 9, 1),
        lambda m: m.getVisualShapeData(9),
        lambda m: m.getJointStates(0, []),
        lambda m: m.setJointMotorControlArray(0, [], 0),
        lambda m: m.getLinkState(0, 99),
        lambda m: m.resetBasePositionAndOrientation(9, [0, 0, 0], [0, 0, 0, 1]),
        lambda m: m.changeDynamics(9, 0, mass=1),
        lambda m: m.getBodyUniqueId(9),
        lambda m: m.getConnectionInfo(),
        lambda m: m.getConnectionInfo(5),
        lambda m: m.isConnected(),
        lambda m: m.getAPIVersion(),
        lambda m: m.isNumpyEnabled(),
        lambda m: m.getPhysicsEngineParameters(),
        lambda m: m.addUserDebugLine([0, 0, 0], [1, 0, 0]),
        lambda m: m.addUserDebugText("a", [0, 0, 0]),
        lambda m: m.addUserDebugParameter("a"),
        lambda m: m.getKeyboardEvents(),
        lambda m: m.getMouseEvents(),
        lambda m: m.getDebugVisualizerCamera(),
        lambda m: m.addUserData(0, "key", "value"),
        lambda m: (m.addUserData(0, "key", "value"), m.getUserData(0), m.getNumUserData(0), m.getUserDataInfo(0, 0)),
        lambda m: m.getUserDataId(0, "none"),
        lambda m: (m.saveState(), m.saveState(), m.removeState(0), m.saveState()),
        lambda m: m.rayTest([0, 0, 5], [0, 0, 4]),
        lambda m: m.getOverlappingObjects([9, 9, 9], [10, 10, 10]),
        lambda m: m.getNumConstraints(),
        lambda m: m.getConstraintUniqueId(3),
    ],
)
def test_what_is_not_there_gives_the_same(call: Callable[[Any], Any]) -> None:
    for module in MODULES:
        module.loadURDF("kuka_iiwa/model.urdf", useFixedBase=True)
    alike(call)


@pytest.mark.parametrize(
    "call",
    [
        lambda m: m.getJointInfo(0, 99),
        lambda m: m.getJointInfo(9, 0),
        lambda m: m.getBodyInfo(9),
        lambda m: m.getBasePositionAndOrientation(9),
        lambda m: m.getJointState(0, 99),
        lambda m: m.getJointStates(0, [99]),
        lambda m: m.getLinkState(0, -1),
        lambda m: m.getAABB(9),
        lambda m: m.setJointMotorControl2(0, 99, 2),
        lambda m: m.setJointMotorControl2(0, 0, 9),
        lambda m: m.setJointMotorControlArray(0, [0], 2, targetPositions=[1, 2]),
        lambda m: m.resetJointState(0, 99, 0),
        lambda m: m.resetBaseVelocity(0),
        lambda m: m.changeDynamics(0, 0, contactStiffness=1),
        lambda m: m.getDynamicsInfo(9, 0),
        lambda m: m.getConstraintInfo(9),
        lambda m: m.createConstraint(0, 0, -1, -1, 2, [0, 0, 0], [0, 0, 0], [0, 0, 0]),
        lambda m: m.getCollisionShapeData(9, 0),
        lambda m: m.applyExternalForce(0, 0, [0, 0, 0], [0, 0, 0], 7),
        lambda m: m.restoreState(9),
        lambda m: m.readUserDebugParameter(0),
        lambda m: m.loadTexture("nowhere.png"),
        lambda m: m.loadURDF("nowhere.urdf"),
        lambda m: m.createCollisionShape(m.GEOM_BOX),
        lambda m: m.calculateInverseKinematics(9, 0, [0, 0, 0]),
        lambda m: m.stepSimulation(77),
        lambda m: m.disconnect(77),
        lambda m: m.setGravity([0, 0, 1]),
        lambda m: m.getJointState(0),
        lambda m: m.getJointState(0, 0.0),
        lambda m: m.getJointState(0, 0, nonsense=1),
    ],
)
def test_errors_are_of_the_same_kind(call: Callable[[Any], Any]) -> None:
    kinds = []
    for module in MODULES:
        module.loadURDF("kuka_iiwa/model.urdf", useFixedBase=True)
        with pytest.raises((module.error, TypeError)) as caught:
            call(module)
        kinds.append("error" if caught.type is module.error else "TypeError")
    assert kinds[0] == kinds[1]
