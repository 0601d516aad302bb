"""manyhands.pybullet without PyBullet: what its clients rely on, and what bad input gives."""

import functools
import inspect
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import manyhands as mh
import manyhands.pybullet as p

ARM = Path(mh.asset_path("arm6/arm6.urdf"))
PANDA = Path(mh.asset_path("panda/panda.urdf"))


@pytest.fixture
def client() -> Iterator[int]:
    number = p.connect(p.DIRECT)
    yield number
    if p.isConnected(number):
        p.disconnect(number)


@pytest.fixture
def sim(client: int) -> Any:
    """The module with its client bound, as BulletClient does it."""

    class Bound:
        def __getattr__(self, name: str) -> Any:
            attribute = getattr(p, name)
            return functools.partial(attribute, physicsClientId=client) if inspect.isbuiltin(attribute) else attribute

    return Bound()


def box(sim: Any, half: float = 0.1, mass: float = 1, at: tuple[float, float, float] = (0, 0, 1)) -> int:
    return sim.createMultiBody(mass, sim.createCollisionShape(p.GEOM_BOX, halfExtents=[half] * 3), -1, at)


def ground(sim: Any) -> int:
    return sim.createMultiBody(0, sim.createCollisionShape(p.GEOM_PLANE))


def steps(sim: Any, n: int) -> None:
    for _ in range(n):
        sim.stepSimulation()


def test_all_functions_are_built_in_and_say_what_they_do() -> None:
    functions = [f for name, f in vars(p).items() if callable(f) and not name.startswith("_") and name != "error"]
    assert len(functions) > 130
    for function in functions:
        assert inspect.isbuiltin(function), function
        assert function.__doc__
    assert list(inspect.signature(p.getJointInfo).parameters) == ["bodyUniqueId", "jointIndex", "physicsClientId"]


def test_clients_are_worlds_of_their_own() -> None:
    first, second = p.connect(p.DIRECT), p.connect(p.DIRECT)
    p.setGravity(0, 0, -1, physicsClientId=first)
    assert p.getPhysicsEngineParameters(physicsClientId=second)["gravityAccelerationZ"] == 0
    p.disconnect(first)
    assert p.connect(p.DIRECT) == first
    with pytest.raises(p.error, match="Not connected to physics server"):
        p.stepSimulation(physicsClientId=1000)
    p.disconnect(first)
    p.disconnect(second)
    assert p.isConnected(second) == 0


def test_free_fall_is_symplectic(sim: Any) -> None:
    ball = box(sim, at=(0, 0, 100))
    sim.changeDynamics(ball, -1, linearDamping=0, angularDamping=0)
    sim.setGravity(0, 0, -10)
    steps(sim, 240)
    # The engine's own free fall is exact; PyBullet drops by 5.0208 m.
    assert sim.getBaseVelocity(ball)[0][2] == pytest.approx(-10)
    assert 100 - sim.getBasePositionAndOrientation(ball)[0][2] == pytest.approx(5, abs=0.03)


def test_damping_of_motion(sim: Any) -> None:
    ball = box(sim)
    sim.resetBaseVelocity(ball, [1, 0, 0])
    steps(sim, 240)
    assert sim.getBaseVelocity(ball)[0][0] == pytest.approx(0.9245, abs=1e-3)


def test_frictions_multiply(sim: Any) -> None:
    sim.setGravity(0, 0, -10)
    ground(sim)
    slider = box(sim, at=(0, 0, 0.1))
    sim.changeDynamics(slider, -1, linearDamping=0, angularDamping=0)
    steps(sim, 10)
    sim.resetBaseVelocity(slider, [2, 0, 0])
    steps(sim, 60)
    assert sim.getBaseVelocity(slider)[0][0] == pytest.approx(2 - 0.25 * 10 * 0.25, abs=0.01)


def test_position_control_takes_a_share_of_the_error_in_each_step(sim: Any) -> None:
    arm = sim.loadURDF(str(PANDA), useFixedBase=True)
    sim.setJointMotorControl2(arm, 0, p.POSITION_CONTROL, targetPosition=1, force=1e5)
    path = []
    for _ in range(3):
        sim.stepSimulation()
        path.append(sim.getJointState(arm, 0)[0])
    assert path == pytest.approx([0.1, 0.19, 0.271], abs=1e-9)


def test_a_new_arm_holds_itself_until_its_motors_are_off(sim: Any) -> None:
    sim.setGravity(0, 0, -9.81)
    arm = sim.loadURDF(str(ARM), useFixedBase=True)
    joints = [j for j in range(sim.getNumJoints(arm)) if sim.getJointInfo(arm, j)[2] != p.JOINT_FIXED]
    start = [s[0] for s in sim.getJointStates(arm, joints)]
    steps(sim, 50)
    assert [s[0] for s in sim.getJointStates(arm, joints)] == pytest.approx(start, abs=1e-6)
    sim.setJointMotorControlArray(arm, joints, p.VELOCITY_CONTROL, forces=[0] * len(joints))
    steps(sim, 50)
    assert max(abs(s[0] - q) for s, q in zip(sim.getJointStates(arm, joints), start, strict=True)) > 0.01


def test_lengths_of_results(sim: Any) -> None:
    sim.setGravity(0, 0, -9.81)
    arm = sim.loadURDF(str(PANDA), useFixedBase=True)
    ground(sim)
    thing = box(sim, at=(1, 0, 0.1))
    steps(sim, 5)
    assert len(sim.getLinkState(arm, 3)) == 6
    assert len(sim.getLinkState(arm, 3, computeLinkVelocity=1)) == 8
    assert len(sim.getJointInfo(arm, 0)) == 17
    assert all(len(contact) == 14 for contact in sim.getContactPoints(thing))
    assert len(sim.getContactPoints(thing)) == 4
    assert len(sim.rayTest([1, 0, 2], [1, 0, 0])[0]) == 5
    assert len(sim.getDynamicsInfo(thing, -1)) == 12
    assert len(sim.getVisualShapeData(arm)[0]) == 8
    assert len(sim.getCollisionShapeData(thing, -1)[0]) == 7
    assert len(sim.getDebugVisualizerCamera()) == 12
    weld = sim.createConstraint(thing, -1, -1, -1, p.JOINT_FIXED, [0, 0, 0], [0, 0, 0], [1, 0, 0.1])
    assert len(sim.getConstraintInfo(weld)) == 15


def test_pictures(sim: Any) -> None:
    thing = box(sim, at=(0, 0, 0))
    view = sim.computeViewMatrix([2, 0, 0], [0, 0, 0], [0, 0, 1])
    projection = sim.computeProjectionMatrixFOV(60, 1.5, 0.1, 10)
    assert projection[0] == pytest.approx(1.1547005) and projection[14] == pytest.approx(-0.2020202)
    width, height, rgba, depth, mask = sim.getCameraImage(60, 40, view, projection)
    assert (width, height) == (60, 40) and rgba.shape == (40, 60, 4) and rgba.dtype == np.uint8
    assert depth.dtype == np.float32 and mask.dtype == np.int32
    near, far, d = 0.1, 10.0, float(depth[20, 30])
    assert far * near / (far - (far - near) * d) == pytest.approx(1.9, abs=1e-3)
    assert mask[20, 30] == thing and mask[0, 0] == -1 and depth[0, 0] == 1
    sim.changeVisualShape(thing, -1, rgbaColor=[1, 0, 0, 1])
    red = sim.getCameraImage(60, 40, view, projection)[2][20, 30]
    assert red[0] > 2 * red[1]
    linked = sim.getCameraImage(60, 40, view, projection, flags=p.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX)[4]
    assert linked[20, 30] & 0xFFFFFF == thing and (linked[20, 30] >> 24) - 1 == -1


def test_a_state_in_contact_comes_back_bit_for_bit(sim: Any) -> None:
    sim.setGravity(0, 0, -9.81)
    ground(sim)
    things = [box(sim, 0.05, at=(0.01 * i, 0, 0.05 + 0.1 * i)) for i in range(4)]
    steps(sim, 100)
    kept = sim.saveState()
    steps(sim, 50)
    first = [sim.getBasePositionAndOrientation(b) for b in things]
    sim.restoreState(kept)
    steps(sim, 50)
    assert [sim.getBasePositionAndOrientation(b) for b in things] == first
    with pytest.raises(p.error, match="Couldn't restore state"):
        sim.restoreState(99)


def test_bodies_come_and_go(sim: Any) -> None:
    first, second, third = (box(sim, at=(i, 0, 0)) for i in range(3))
    sim.removeBody(second)
    assert sim.getNumBodies() == 2
    assert [sim.getBodyUniqueId(i) for i in range(3)] == [first, third, -1]
    assert sim.getBasePositionAndOrientation(third)[0] == pytest.approx((2, 0, 0))
    assert box(sim, at=(5, 0, 0)) == second
    steps(sim, 3)
    assert sim.getBasePositionAndOrientation(second)[0] == pytest.approx((5, 0, 0))
    sim.resetSimulation()
    assert sim.getNumBodies() == 0 and box(sim) == 0


def test_a_fixed_body_can_be_put_elsewhere(sim: Any) -> None:
    ghost = box(sim, mass=0, at=(0, 0, 0))
    sim.resetBasePositionAndOrientation(ghost, [1, 2, 3], [0, 0, math.sin(0.1), math.cos(0.1)])
    sim.stepSimulation()
    position, orientation = sim.getBasePositionAndOrientation(ghost)
    assert position == pytest.approx((1, 2, 3)) and orientation[2] == pytest.approx(math.sin(0.1))
    assert sim.getDynamicsInfo(ghost, -1)[0] == 0
    sim.changeDynamics(ghost, -1, mass=2)
    sim.setGravity(0, 0, -9.81)
    steps(sim, 24)
    assert sim.getBasePositionAndOrientation(ghost)[0][2] < 2.96


def test_collisions_can_be_switched_off(sim: Any) -> None:
    sim.setGravity(0, 0, -9.81)
    floor = ground(sim)
    through, held = box(sim, at=(0, 0, 0.2)), box(sim, at=(1, 0, 0.2))
    sim.setCollisionFilterPair(floor, through, -1, -1, 0)
    masked = box(sim, at=(2, 0, 0.2))
    sim.setCollisionFilterGroupMask(masked, -1, 0, 0)
    steps(sim, 120)
    heights = [sim.getBasePositionAndOrientation(b)[0][2] for b in (through, held, masked)]
    assert heights[0] < -0.5 and heights[1] == pytest.approx(0.1, abs=1e-3) and heights[2] < -0.5


def test_inverse_kinematics_reaches_its_target(sim: Any) -> None:
    arm = sim.loadURDF(str(PANDA), useFixedBase=True)
    names = [sim.getJointInfo(arm, j)[12].decode() for j in range(sim.getNumJoints(arm))]
    hand = names.index("panda_grasptarget")
    moving = [j for j in range(len(names)) if sim.getJointInfo(arm, j)[3] > -1]
    for j, q in zip(moving, [0, 0.41, 0, -1.85, 0, 2.26, 0.79, 0.02, 0.02], strict=True):
        sim.resetJointState(arm, j, q)
    target = [0.5, 0.1, 0.4]
    q = sim.calculateInverseKinematics(arm, hand, target, [1, 0, 0, 0], maxNumIterations=200)
    assert len(q) == len(moving)
    for j, x in zip(moving, q, strict=True):
        sim.resetJointState(arm, j, x)
    assert sim.getLinkState(arm, hand)[4] == pytest.approx(target, abs=2e-3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.loadURDF("nowhere.urdf"), "Cannot load URDF file"),
        (lambda s: s.getJointInfo(99, 0), "GetJointInfo failed"),
        (lambda s: s.getBasePositionAndOrientation(99), "GetBasePositionAndOrientation failed"),
        (lambda s: s.setJointMotorControl2(0, 99, 2), "Joint index out-of-range"),
        (lambda s: s.getLinkState(0, -1), "invalid linkIndex"),
        (lambda s: s.applyExternalForce(0, 0, [0, 0, 0], [0, 0, 0], 7), "WORLD_FRAME or LINK_FRAME"),
        (lambda s: s.createCollisionShape(p.GEOM_BOX), "createCollisionShape failed"),
        (lambda s: s.createCollisionShape(p.GEOM_MESH, fileName="no.obj"), "there is no file 'no.obj'"),
        (lambda s: s.changeDynamics(0, 0, lateralFriction=math.nan), "a number is nan"),
        (lambda s: s.createConstraint(0, 0, -1, -1, p.JOINT_SPHERICAL, [0, 0, 0], [0, 0, 0], [0, 0, 0]), "failed"),
        (lambda s: s.changeDynamics(0, 0, contactStiffness=10), "needs to be set together"),
        (lambda s: s.getQuaternionFromEuler([0, 0]), "Euler angles need a 3 coordinates"),
        (lambda s: s.resetBasePositionAndOrientation(0, [math.nan, 0, 0], [0, 0, 0, 1]), "not finite"),
        (lambda s: s.calculateMassMatrix(0, [0, 0]), "one for each joint that moves"),
        (lambda s: s.readUserDebugParameter(0), "Failed to read parameter"),
        (lambda s: s.createMultiBody(1, linkMasses=[1], linkPositions=[]), "same size"),
        (lambda s: s.setTimeStep(0), "above 0"),
    ],
)
def test_bad_input_is_an_error_in_one_line(sim: Any, call: Any, message: str) -> None:
    arm = sim.loadURDF(str(PANDA), useFixedBase=True)
    before = sim.getJointStates(arm, range(3))
    with pytest.raises(p.error, match=message) as caught:
        call(sim)
    assert "\n" not in str(caught.value)
    assert sim.getJointStates(arm, range(3)) == before


def test_wrong_types_are_type_errors(sim: Any) -> None:
    arm = sim.loadURDF(str(PANDA), useFixedBase=True)
    for wrong in (
        lambda: sim.setGravity([0, 0, -10]),
        lambda: sim.setJointMotorControl2(arm, 0.0, 2),
        lambda: sim.loadURDF(PANDA),
        lambda: sim.getJointState(arm),
        lambda: sim.getJointState(arm, 0, colour=3),
    ):
        with pytest.raises(TypeError):
            wrong()


def test_what_is_missing_says_so(sim: Any) -> None:
    with pytest.raises(NotImplementedError, match="loadSoftBody"):
        p.loadSoftBody("duck.vtk")


def test_arrays_and_numpy_numbers_pass(sim: Any) -> None:
    arm = sim.loadURDF(str(PANDA), np.zeros(3), np.array([0, 0, 0, 1.0]), useFixedBase=np.int64(1))
    sim.setJointMotorControlArray(arm, np.arange(3), p.POSITION_CONTROL, targetPositions=np.full(3, 0.1, np.float32))
    sim.calculateMassMatrix(arm, np.zeros(9))
    assert isinstance(sim.getJointState(np.int32(arm), 0)[0], float)


def test_memory_and_ids_stay_flat_while_bodies_come_and_go(sim: Any) -> None:
    shape = sim.createCollisionShape(p.GEOM_SPHERE, radius=0.1)
    for _ in range(2000):
        sim.removeBody(sim.createMultiBody(1, shape))
    assert sim.createMultiBody(1, shape) == 0
