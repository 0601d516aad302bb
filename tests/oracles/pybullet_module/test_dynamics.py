"""Masses and materials: every option of changeDynamics, what is told of it and what it does."""

import numpy as np
import pytest
from bodies import ARM, DOFS, add_arm, add_box, set_free, solve_to_the_end

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(3))


@seeds
@pytest.mark.parametrize(
    "option",
    [
        "mass",
        "lateralFriction",
        "spinningFriction",
        "rollingFriction",
        "restitution",
        "linearDamping",
        "angularDamping",
        "ccdSweptSphereRadius",
        "contactProcessingThreshold",
        "jointDamping",
        "maxJointVelocity",
        "collisionMargin",
        "jointLimitForce",
        "sleepThreshold",
        "frictionAnchor",
        "activationState",
    ],
)
def test_a_number_is_kept(both: Beside, rng: np.random.Generator, option: str) -> None:
    both.loadURDF(ARM, useFixedBase=True)
    add_box(both, [1, 0, 1])
    most = 1 if option == "restitution" else 2
    value = 1 if option in ("frictionAnchor", "activationState") else rng.uniform(0.1, most)
    for body, link in ((1, -1),) if option == "collisionMargin" else ((0, 3), (0, 6), (1, -1)):
        both.changeDynamics(body, link, **{option: value})
        both.getDynamicsInfo(body, link, within=1e-5)


@seeds
def test_several_numbers_are_kept(both: Beside, rng: np.random.Generator) -> None:
    box = add_box(both, [1, 0, 1])
    both.changeDynamics(box, -1, contactStiffness=rng.uniform(1e3, 1e5), contactDamping=rng.uniform(1, 100))
    both.getDynamicsInfo(box, -1)
    both.changeDynamics(box, -1, localInertiaDiagonal=rng.uniform(0.1, 1, 3).tolist())
    both.getDynamicsInfo(box, -1)
    both.changeDynamics(bodyUniqueId=box, linkIndex=-1, anisotropicFriction=[1, 0.5, 0.1], mass=2)
    both.getDynamicsInfo(bodyUniqueId=box, linkIndex=-1)
    both.changeDynamics(99, 0, mass=1)
    both.changeDynamics(box, -1, mass=-1)
    both.getDynamicsInfo(box, -1)


@seeds
def test_masses_and_inertias_act(both: Beside, rng: np.random.Generator) -> None:
    solve_to_the_end(both)
    arm = add_arm(both, rng)
    set_free(both, arm, DOFS)
    for joint in DOFS:
        both.changeDynamics(arm, joint, mass=rng.uniform(1, 4), localInertiaDiagonal=rng.uniform(0.02, 0.2, 3).tolist())
    for _ in range(24):
        both.stepSimulation()
        both.getJointStates(arm, DOFS, view=lambda states: [state[0] for state in states], within=1e-4)


def test_a_base_stands_and_falls(both: Beside) -> None:
    both.setGravity(0, 0, -9.81)
    box = add_box(both, [0, 0, 1])
    for mass in (0, 2):
        both.changeDynamics(box, -1, mass=mass)
        both.step(10)
        both.getBasePositionAndOrientation(box, within=1e-3)


@seeds
def test_new_limits_hold(both: Beside, rng: np.random.Generator) -> None:
    """The real module stops a joint one step late and lets it swing: where it comes to rest is compared."""
    cart = both.loadURDF("cartpole.urdf", useFixedBase=True)
    both.setJointMotorControl2(cart, 1, both.VELOCITY_CONTROL, force=0)
    both.changeDynamics(cart, 0, jointLowerLimit=-0.2, jointUpperLimit=0.2)
    both.setJointMotorControl2(cart, 0, both.VELOCITY_CONTROL, targetVelocity=1, force=5)
    both.step(480)
    both.getJointState(cart, 0, view=lambda state: state[0], within=2e-2)


@seeds
def test_speeds_are_capped(both: Beside, rng: np.random.Generator) -> None:
    box = add_box(both, [0, 0, 1])
    both.changeDynamics(box, -1, linearDamping=0, angularDamping=0, maxJointVelocity=2)
    both.resetBaseVelocity(box, [5, 0, 0], [0, 7, 0])
    both.step(3)
    both.getBaseVelocity(box, within=1e-4)


@pytest.mark.parametrize(
    "call",
    [
        ("changeDynamics", 0, 0, {"contactStiffness": 1}),
        ("changeDynamics", 0, 0, {"contactDamping": 1}),
        ("changeDynamics", 0, 0, {"mass": "heavy"}),
        ("changeDynamics", 0, 0, {"nonsense": 1}),
        ("changeDynamics", 0),
        ("getDynamicsInfo", 9, 0),
        ("getDynamicsInfo", 0),
    ],
    ids=str,
)
def test_wrong_dynamics(both: Beside, call: tuple[object, ...]) -> None:
    both.loadURDF(ARM, useFixedBase=True)
    options = call[-1] if isinstance(call[-1], dict) else {}
    both.refuses(*(x for x in call if not isinstance(x, dict)), **options)
