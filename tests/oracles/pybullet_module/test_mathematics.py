"""Rotations, transforms and camera matrices, of random arguments."""

import numpy as np
import pytest

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(20))


@seeds
def test_rotations(both: Beside, rng: np.random.Generator) -> None:
    a, b = ([*(x / np.linalg.norm(x))] for x in rng.normal(size=(2, 4)))
    u, v = rng.normal(size=(2, 3)).tolist()
    angle, share = rng.uniform(-6, 6), rng.uniform()
    both.getQuaternionFromEuler(eulerAngles=u)
    both.getEulerFromQuaternion(quaternion=a)
    both.getMatrixFromQuaternion(quaternion=a)
    both.multiplyTransforms(u, a, v, b)
    both.multiplyTransforms(positionA=v, orientationA=b, positionB=u, orientationB=a)
    both.invertTransform(position=u, orientation=a)
    both.rotateVector(quaternion=a, vector=u)
    both.getQuaternionFromAxisAngle(axis=u, angle=angle)
    both.getAxisAngleFromQuaternion(quaternion=a)
    both.getDifferenceQuaternion(quaternionStart=a, quaternionEnd=b)
    both.getAxisDifferenceQuaternion(quaternionStart=a, quaternionEnd=b)
    both.getQuaternionSlerp(quaternionStart=a, quaternionEnd=b, interpolationFraction=share)
    both.calculateVelocityQuaternion(quaternionStart=a, quaternionEnd=b, deltaTime=0.1, within=1e-4)


@seeds
def test_arrays_and_tuples_are_taken_alike(both: Beside, rng: np.random.Generator) -> None:
    a, u = rng.normal(size=4), rng.normal(size=3)
    a /= np.linalg.norm(a)
    for kind in (list, tuple, np.asarray):
        both.rotateVector(kind(a), kind(u))
        both.getEulerFromQuaternion(kind(a))
        both.getQuaternionFromEuler(kind(u))


@seeds
def test_camera_matrices(both: Beside, rng: np.random.Generator) -> None:
    eye, target = rng.normal(size=(2, 3)).tolist()
    yaw, pitch, roll = rng.uniform(-80, 80, 3).tolist()
    distance = rng.uniform(0.5, 4)
    both.computeViewMatrix(eye, target, [0, 0, 1], within=1e-5)
    both.computeViewMatrix(cameraEyePosition=eye, cameraTargetPosition=target, cameraUpVector=[0, 1, 0], within=1e-5)
    for up in (1, 2):
        both.computeViewMatrixFromYawPitchRoll(target, distance, yaw, pitch, roll, up, within=1e-5)
    near, far = rng.uniform(0.01, 0.2), rng.uniform(5, 100)
    both.computeProjectionMatrix(-1, 2, -1, 1.5, near, far, within=1e-5)
    both.computeProjectionMatrixFOV(fov=rng.uniform(20, 100), aspect=1.5, nearVal=near, farVal=far, within=1e-5)


@pytest.mark.parametrize("bad", [[], [1, 2], [1, 2, 3, 4, 5]])
def test_wrong_vectors(both: Beside, bad: object) -> None:
    good, unit = [0.1, 0.2, 0.3], [0, 0, 0, 1]
    for name, arguments in {
        "getQuaternionFromEuler": [good],
        "getEulerFromQuaternion": [unit],
        "getMatrixFromQuaternion": [unit],
        "multiplyTransforms": [good, unit, good, unit],
        "invertTransform": [good, unit],
        "rotateVector": [unit, good],
        "getAxisAngleFromQuaternion": [unit],
        "getQuaternionSlerp": [unit, unit, 0.5],
    }.items():
        for i in range(len(arguments)):
            both.refuses(name, *arguments[:i], bad, *arguments[i + 1 :])
