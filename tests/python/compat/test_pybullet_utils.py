"""manyhands.pybullet_utils beside the package of that name."""

import gc
import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from manyhands import pybullet as ours
from manyhands.pybullet_utils import pd_controller_stable, transformations
from manyhands.pybullet_utils.bullet_client import BulletClient

pybullet = pytest.importorskip("pybullet")
data: Any = pytest.importorskip("pybullet_data")
real_transformations: Any = pytest.importorskip("pybullet_utils.transformations")
real_pd: Any = pytest.importorskip("pybullet_utils.pd_controller_stable")
real_client: Any = pytest.importorskip("pybullet_utils.bullet_client")


AXES = [
    f"{frame}{''.join(letters)}"
    for frame in "sr"
    for letters in itertools.product("xyz", repeat=3)
    if letters[0] != letters[1] != letters[2]
]


@pytest.fixture
def client() -> Iterator[Any]:
    made = real_client.BulletClient(pybullet.DIRECT)
    made.setAdditionalSearchPath(data.getDataPath())
    yield made
    made.disconnect()


def test_each_client_has_its_own_world() -> None:
    first, second = BulletClient(ours.DIRECT), BulletClient()  # nobody shares memory: the second is new
    assert first._client != second._client
    first.setGravity(0, 0, -5)
    for _ in range(2):  # the second call takes another way than the first
        first.createCollisionShape(ours.GEOM_SPHERE, radius=0.1)
        first.createMultiBody(1.0)
    assert (first.getNumBodies(), second.getNumBodies()) == (2, 0)
    assert first.getPhysicsEngineParameters()["gravityAccelerationZ"] == -5
    assert first.DIRECT == ours.DIRECT and first.error is ours.error
    first.disconnect()
    assert first._client == -1
    with pytest.raises(ours.error):
        first.stepSimulation()
    with pytest.raises(ours.error):
        first.disconnect()
    with pytest.raises(AttributeError, match="no_such"):
        second.no_such()
    assert second.isConnected() == 1
    second.disconnect()


def test_a_forgotten_client_disconnects() -> None:
    number = BulletClient(ours.DIRECT)._client
    gc.collect()
    assert ours.isConnected(number) == 0


def test_a_client_that_cannot_connect() -> None:
    with pytest.raises(ours.error):
        BulletClient(98765)


@pytest.mark.parametrize("fixed", [True, False])
def test_stable_pd(client: Any, fixed: bool) -> None:
    body = client.loadURDF("cartpole.urdf" if fixed else "kuka_iiwa/model.urdf", useFixedBase=fixed)
    client.changeDynamics(body, -1, mass=0 if fixed else 3)
    joints = list(range(client.getNumJoints(body)))
    rng = np.random.default_rng(4)
    for joint in joints:
        client.resetJointState(body, joint, rng.normal(), rng.normal())
    base = 0 if fixed else 7
    wanted = rng.normal(size=len(joints) + base)
    rates = rng.normal(size=len(joints) + (0 if fixed else 6))
    kps, kds = rng.uniform(1, 100, len(rates)), rng.uniform(1, 10, len(rates))
    limits = rng.uniform(10, 200, len(rates))
    arguments = body, joints, wanted.tolist(), rates.tolist(), kps, kds, limits, 0.01
    expected = real_pd.PDControllerStable(client).computePD(*arguments)
    found = pd_controller_stable.PDControllerStable(client).computePD(*arguments)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_stable_pd_of_a_humanoid(client: Any) -> None:
    body = client.loadURDF("humanoid/humanoid.urdf", globalScaling=0.25, flags=pybullet.URDF_MAINTAIN_LINK_ORDER)
    rng = np.random.default_rng(5)
    types = [client.getJointInfo(body, i)[2] for i in range(client.getNumJoints(body))]
    joints = [i for i, kind in enumerate(types) if kind in (pybullet.JOINT_SPHERICAL, pybullet.JOINT_REVOLUTE)]
    wanted = [*rng.normal(size=3), 0.0, 0.0, 0.0, 1.0]
    for joint in joints:
        if types[joint] == pybullet.JOINT_SPHERICAL:
            turn = transformations.random_quaternion(rng.random(3)).tolist()
            client.resetJointStateMultiDof(body, joint, turn, rng.normal(size=3).tolist())
            # Less than half a turn away: PyBullet's goes the long way where the product's sign says so.
            nearby = transformations.quaternion_from_euler(*rng.uniform(-0.5, 0.5, 3))
            wanted += transformations.quaternion_multiply(turn, nearby).tolist()
        else:
            client.resetJointState(body, joint, rng.normal(), rng.normal())
            wanted.append(rng.normal())
    size = len(wanted)
    kps, kds, limits = rng.uniform(1, 300, size), rng.uniform(1, 30, size), rng.uniform(50, 500, size)
    arguments = body, joints, wanted, [0.0] * size, kps, kds, limits, 1 / 240
    expected = real_pd.PDControllerStableMultiDof(client).computePD(*arguments)
    found = pd_controller_stable.PDControllerStableMultiDof(client).computePD(*arguments)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-3)  # PyBullet turns quaternions in single precision


@pytest.mark.parametrize("axes", AXES)
def test_euler_angles(axes: str) -> None:
    rng = np.random.default_rng(0)
    assert len(AXES) == 24
    for angles in rng.uniform(-3, 3, (20, 3)):
        matrix = real_transformations.euler_matrix(*angles, axes)
        np.testing.assert_allclose(transformations.euler_matrix(*angles, axes), matrix, atol=1e-12)
        quaternion = real_transformations.quaternion_from_euler(*angles, axes)
        np.testing.assert_allclose(transformations.quaternion_from_euler(*angles, axes), quaternion, atol=1e-12)
        expected = real_transformations.euler_from_matrix(matrix, axes)
        np.testing.assert_allclose(transformations.euler_from_matrix(matrix, axes), expected, atol=1e-9)
        np.testing.assert_allclose(transformations.euler_from_quaternion(quaternion, axes), expected, atol=1e-9)
    for angles in itertools.product([0, np.pi / 2, -np.pi / 2, np.pi], repeat=3):  # where two angles are one
        matrix = real_transformations.euler_matrix(*angles, axes)
        again = transformations.euler_matrix(*transformations.euler_from_matrix(matrix, axes), axes)
        np.testing.assert_allclose(again, matrix, atol=1e-9)


@pytest.mark.parametrize("axes", ["sxxy", "xyz", "txyz", "sxyw"])
def test_axes_that_there_are_not(axes: str) -> None:
    with pytest.raises(ValueError, match=repr(axes)):
        transformations.euler_matrix(0, 0, 0, axes)


def test_quaternions_and_matrices() -> None:
    rng = np.random.default_rng(1)
    real, ours = real_transformations, transformations
    for _ in range(50):
        draws = rng.random(3)
        a, b = ours.random_quaternion(draws), ours.random_quaternion(rng.random(3))
        point, fraction = rng.normal(size=3), rng.random()
        pairs = [
            (a, real.random_quaternion(draws)),
            (ours.quaternion_multiply(a, b), real.quaternion_multiply(a, b)),
            (ours.quaternion_inverse(2 * a), real.quaternion_inverse(2 * a)),
            (ours.quaternion_slerp(a, b, fraction), real.quaternion_slerp(a, b, fraction)),
            (ours.quaternion_slerp(a, b, fraction, 1, False), real.quaternion_slerp(a, b, fraction, 1, False)),
            (ours.rotation_matrix(fraction, b[:3], point), real.rotation_matrix(fraction, b[:3], point)),
            (ours.quaternion_matrix(3 * a), real.quaternion_matrix(3 * a)),
        ]
        for found, expected in pairs:
            np.testing.assert_allclose(found, expected, atol=1e-12)
        back = ours.quaternion_from_matrix(ours.quaternion_matrix(a))
        assert abs(back @ a) == pytest.approx(1, abs=1e-12)
        matrix = ours.concatenate_matrices(ours.translation_matrix(point), ours.quaternion_matrix(b))
        np.testing.assert_allclose(ours.translation_from_matrix(matrix), point)
        assert ours.is_same_transform(ours.inverse_matrix(ours.inverse_matrix(matrix)), matrix)
        assert not ours.is_same_transform(matrix, ours.identity_matrix())
