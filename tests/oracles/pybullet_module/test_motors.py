"""Motors, torques and pushes on an arm in the air, with every option, over a tenth of a second."""

import numpy as np
import pytest
from bodies import DOFS, add_arm, place, set_free, solve_to_the_end

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(3))


def free_arm(both: Beside, rng: np.random.Generator) -> int:
    solve_to_the_end(both)
    arm = add_arm(both, rng)
    set_free(both, arm, DOFS)
    return arm


def follow(both: Beside, arm: int, within: float = 1e-4, steps: int = 24) -> None:
    """Positions are compared in each step."""
    for _ in range(steps):
        both.stepSimulation()
        both.getJointStates(arm, DOFS, view=lambda states: [state[0] for state in states], within=within)


@seeds
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"force": 3000},
        {"positionGain": 0.03},
        {"positionGain": 0.03, "velocityGain": 0.5},
        {"targetVelocity": 0.3},
        {"maxVelocity": 0.4},
    ],
    ids=str,
)
def test_positions(both: Beside, rng: np.random.Generator, options: dict[str, float]) -> None:
    arm = free_arm(both, rng)
    for joint in DOFS:
        both.setJointMotorControl2(
            arm, joint, both.POSITION_CONTROL, targetPosition=rng.uniform(-1, 1), **({"force": 3000} | options)
        )
    follow(both, arm)


@seeds
@pytest.mark.parametrize("options", [{}, {"force": 3000}, {"velocityGain": 0.4}, {"force": 40}, {"force": 0}], ids=str)
def test_velocities(both: Beside, rng: np.random.Generator, options: dict[str, float]) -> None:
    arm = free_arm(both, rng)
    for joint in DOFS:
        both.setJointMotorControl2(
            arm, joint, controlMode=both.VELOCITY_CONTROL, targetVelocity=rng.uniform(-1, 1), **options
        )
    follow(both, arm, within=1e-3)


@seeds
def test_default_motors_hold(both: Beside, rng: np.random.Generator) -> None:
    arm = add_arm(both, rng)
    follow(both, arm)
    both.setTimeStep(0.002)
    follow(both, arm, within=1e-3)


@seeds
def test_what_motors_tell(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    for joint in DOFS:
        both.setJointMotorControl2(arm, joint, both.POSITION_CONTROL, targetPosition=0.2, force=3000)
    both.step(12)
    both.getJointStates(arm, DOFS, view=lambda states: [state[3] for state in states], within=1e-2)
    both.getJointStateMultiDof(arm, 3, within=1e-2)


@seeds
def test_explicit_control(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    for joint in range(4):  # explicit gains are too stiff for the light links behind
        both.setJointMotorControl2(
            arm, joint, both.PD_CONTROL, targetPosition=0.4, positionGain=40, velocityGain=2, force=100
        )
    follow(both, arm, within=2e-3, steps=12)


@seeds
def test_torques(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    torques = (rng.uniform(-1, 1, 7) * [20, 20, 10, 10, 2, 0.2, 0.02]).tolist()
    for _ in range(24):
        both.setJointMotorControlArray(arm, DOFS, both.TORQUE_CONTROL, forces=torques)
        both.setJointMotorControl2(arm, 0, both.TORQUE_CONTROL, force=1.5)  # adds to that
        follow(both, arm, steps=1)


@seeds
def test_lists(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    both.setJointMotorControlArray(
        bodyUniqueId=arm,
        jointIndices=np.arange(7),
        controlMode=both.POSITION_CONTROL,
        targetPositions=rng.uniform(-1, 1, 7).tolist(),
        targetVelocities=rng.uniform(-0.2, 0.2, 7).tolist(),
        forces=[3000] * 7,
        positionGains=rng.uniform(0.02, 0.1, 7).tolist(),
        velocityGains=rng.uniform(0.5, 1, 7).tolist(),
    )
    follow(both, arm)
    both.setJointMotorControlArray(arm, [], both.POSITION_CONTROL)
    both.getJointState(arm, 0, view=lambda state: state[0], within=1e-4)


@seeds
def test_the_old_form(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    for joint in DOFS:
        both.setJointMotorControl(arm, joint, both.POSITION_CONTROL, rng.uniform(-1, 1), 3000)
    follow(both, arm)


@seeds
def test_lists_for_each_joint(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    for joint in DOFS:
        both.setJointMotorControlMultiDof(
            arm,
            joint,
            both.POSITION_CONTROL,
            targetPosition=[rng.uniform(-1, 1)],
            targetVelocity=[0],
            force=[3000],
            positionGain=0.05,
            velocityGain=1,
        )
    follow(both, arm)


def ball(both: Beside, rng: np.random.Generator) -> int:
    """A link on a spherical joint of a base that stands."""
    shape = both.createCollisionShape(both.GEOM_BOX, halfExtents=rng.uniform(0.1, 0.3, 3).tolist())
    body = both.createMultiBody(
        0,
        linkMasses=[1],
        linkCollisionShapeIndices=[shape],
        linkVisualShapeIndices=[-1],
        linkPositions=[[0, 0, 0]],
        linkOrientations=[[0, 0, 0, 1]],
        linkInertialFramePositions=[[0, 0, 0]],
        linkInertialFrameOrientations=[[0, 0, 0, 1]],
        linkParentIndices=[0],
        linkJointTypes=[both.JOINT_SPHERICAL],
        linkJointAxis=[[0, 0, 1]],
    )
    for link in (-1, 0):
        both.changeDynamics(body, link, linearDamping=0, angularDamping=0)
    return body


@seeds
@pytest.mark.parametrize("gain", [0.05, 0.1])
def test_a_spherical_joint_aims(both: Beside, rng: np.random.Generator, gain: float) -> None:
    solve_to_the_end(both)
    body, target = ball(both, rng), both.getQuaternionFromEuler(rng.uniform(-0.4, 0.4, 3).tolist())
    both.setJointMotorControlMultiDof(
        body, 0, both.POSITION_CONTROL, targetPosition=target, positionGain=gain, velocityGain=1, force=[1000] * 3
    )
    for _ in range(20):
        both.stepSimulation()
        both.getJointStateMultiDof(body, 0, view=lambda state: state[0], within=2e-3)


@seeds
def test_several_spherical_joints_aim(both: Beside, rng: np.random.Generator) -> None:
    solve_to_the_end(both)
    body, target = ball(both, rng), both.getQuaternionFromEuler(rng.uniform(-0.4, 0.4, 3).tolist())
    both.setJointMotorControlMultiDofArray(
        body, [0], both.POSITION_CONTROL, targetPositions=[target], positionGains=[0.1], forces=[[1000] * 3]
    )
    for _ in range(5):
        both.stepSimulation()
        both.getJointStateMultiDof(body, 0, view=lambda state: state[0], within=2e-3)


@seeds
def test_pushes(both: Beside, rng: np.random.Generator) -> None:
    arm = free_arm(both, rng)
    for _ in range(12):
        both.applyExternalForce(arm, 3, rng.normal(size=3).tolist(), place(rng, 0.05)[0], both.LINK_FRAME)
        both.applyExternalTorque(arm, 3, (0.2 * rng.normal(size=3)).tolist(), both.WORLD_FRAME)
        both.applyExternalTorque(arm, 2, (0.2 * rng.normal(size=3)).tolist(), flags=both.LINK_FRAME)
        point = both.getLinkState(arm, 4, computeForwardKinematics=1, within=1e-4)[0]
        both.applyExternalForce(arm, 4, forceObj=rng.normal(size=3).tolist(), posObj=point, flags=both.WORLD_FRAME)
        follow(both, arm, within=1e-3, steps=1)


@seeds
def test_pushes_on_a_base(both: Beside, rng: np.random.Generator) -> None:
    body = both.loadURDF("cube.urdf", *place(rng))
    for _ in range(12):
        both.applyExternalForce(body, -1, (5 * rng.normal(size=3)).tolist(), place(rng, 0.2)[0], both.LINK_FRAME)
        both.applyExternalTorque(body, -1, rng.normal(size=3).tolist(), both.LINK_FRAME)
        both.stepSimulation()
        both.getBaseVelocity(body, within=5e-3)
    both.applyExternalForce(99, -1, [1, 0, 0], [0, 0, 0], both.WORLD_FRAME)
    both.getBasePositionAndOrientation(body, within=1e-3)


@seeds
@pytest.mark.parametrize("mode", [0, 1, 2])
def test_what_joints_transmit(both: Beside, rng: np.random.Generator, mode: int) -> None:
    """At rest: the real module's arm still swings a little on its motors."""
    both.setPhysicsEngineParameter(jointFeedbackMode=mode)
    arm = add_arm(both, rng)
    solve_to_the_end(both)
    for joint in DOFS:
        both.enableJointForceTorqueSensor(arm, joint, enableSensor=True)
        q = both.getJointState(arm, joint, view=lambda state: state[0])
        both.setJointMotorControl2(arm, joint, both.POSITION_CONTROL, targetPosition=q[0], force=3000)
    both.step(40)
    both.getJointStates(arm, DOFS, view=lambda states: [state[2] for state in states], within=5e-2)


@pytest.mark.parametrize(
    "call",
    [
        ("setJointMotorControl2", 0, 99, 2),
        ("setJointMotorControl2", 9, 0, 2),
        ("setJointMotorControl2", 0, 0, 9),
        ("setJointMotorControl2", 0, 0.0, 2),
        ("setJointMotorControl2", 0, "elbow", 2),
        ("setJointMotorControl2", 0, 0, 2, "far"),
        ("setJointMotorControl2", 0, 0),
        ("setJointMotorControlArray", 0, [0], 2, [1, 2]),
        ("setJointMotorControlArray", 0, [99], 2),
        ("setJointMotorControlArray", 0, [0], 9),
        ("setJointMotorControlArray", 0, [0, 1], 2, {"forces": [1]}),
        ("setJointMotorControlArray", 0, [0, 1], 2, {"positionGains": [1]}),
        ("setJointMotorControlArray", 0, [0, 1], 2, {"velocityGains": [1]}),
        ("setJointMotorControlArray", 0, [0, 1], 0, {"targetVelocities": [1]}),
        ("setJointMotorControlMultiDof", 0, 99, 2),
        ("setJointMotorControlMultiDof", 0, 0, 0),
        ("setJointMotorControlMultiDof", 0, 0, 3),
        ("applyExternalForce", 0, 0, [0, 0, 0], [0, 0, 0], 7),
        ("applyExternalForce", 0, 0, [0, 0, 0], [0, 0, 0]),
        ("applyExternalTorque", 0, 0, [0, 0, 0], 7),
        ("enableJointForceTorqueSensor", 0, 99),
    ],
    ids=str,
)
def test_wrong_motors(both: Beside, call: tuple[object, ...]) -> None:
    both.loadURDF("kuka_iiwa/model.urdf", useFixedBase=True)
    options = call[-1] if isinstance(call[-1], dict) else {}
    both.refuses(*(x for x in call if not isinstance(x, dict)), **options)
