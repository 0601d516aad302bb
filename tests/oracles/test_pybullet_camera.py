"""The same scene and matrices in PyBullet's TinyRenderer: depth and segmentation of a robot of meshes and of boxes."""

from pathlib import Path
from typing import Any

import numpy as np
import pybullet
import pybullet_data
import pytest

import manyhands as mh

WIDTH, HEIGHT, NEAR, FAR = 320, 240, 0.1, 10.0
FOLDER = Path(pybullet_data.getDataPath()) / "franka_panda"
BASE = (-0.6, 0.0, 0.0)
ARM = [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.03, 0.02]
BOXES = {
    "table": ((0.55, 0.35, 0.2), (-0.3, 0.0, -0.2), (0.0, 0.0, 0.0)),
    "brick": ((0.05, 0.03, 0.02), (0.1, 0.1, 0.02), (0.0, 0.0, 0.5)),
    "tilted": ((0.06, 0.04, 0.05), (0.1, -0.2, 0.12), (0.4, 0.7, 0.2)),
}


@pytest.fixture(scope="module")
def scene() -> Any:
    client = pybullet.connect(pybullet.DIRECT)
    robot = pybullet.loadURDF(str(FOLDER / "panda.urdf"), BASE, useFixedBase=True)
    for joint, angle in zip([*range(7), 9, 10], ARM, strict=True):
        pybullet.resetJointState(robot, joint, angle)
    world = mh.World()
    model, _ = mh.load_urdf(FOLDER / "panda.urdf", package_paths=[FOLDER], allow_outside_package=True)
    world.add(model, position=BASE, name="panda")
    names = {"panda/panda_link0": (robot, -1)}
    for i in range(pybullet.getNumJoints(robot)):
        names["panda/" + pybullet.getJointInfo(robot, i)[12].decode()] = (robot, i)
    for name, (half, position, angles) in BOXES.items():
        quaternion = pybullet.getQuaternionFromEuler(angles)
        shape = pybullet.createVisualShape(pybullet.GEOM_BOX, halfExtents=half)
        names[name] = (pybullet.createMultiBody(0, -1, shape, position, quaternion), -1)
        world.add_box(name, half, position=position, quaternion=quaternion, fixed=True)
    world.q = ARM
    yield world, names
    pybullet.disconnect(client)


@pytest.mark.parametrize(("yaw", "pitch", "roll"), [(45, -30, 0), (-20, -50, 10), (100, -15, -30)])
def test_depth_and_segmentation(scene: Any, yaw: float, pitch: float, roll: float) -> None:
    world, names = scene
    view = pybullet.computeViewMatrixFromYawPitchRoll([-0.2, 0, 0.1], 1.4, yaw, pitch, roll, 2)
    projection = pybullet.computeProjectionMatrixFOV(50, WIDTH / HEIGHT, NEAR, FAR)
    *_, buffer, mask = pybullet.getCameraImage(
        WIDTH,
        HEIGHT,
        view,
        projection,
        renderer=pybullet.ER_TINY_RENDERER,
        flags=pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX,
    )
    theirs = FAR * NEAR / (FAR - (FAR - NEAR) * np.reshape(buffer, (HEIGHT, WIDTH)))
    mask = np.reshape(mask, (HEIGHT, WIDTH))

    camera = mh.Camera.from_matrices(WIDTH, HEIGHT, view, projection)
    orbit = camera.orbit([-0.2, 0, 0.1], 1.4, *np.radians([yaw, pitch, roll]))
    np.testing.assert_allclose(orbit.position, camera.position, atol=1e-6)
    np.testing.assert_allclose(np.abs(orbit.quaternion @ camera.quaternion), 1, atol=1e-6)
    # The rays of TinyRenderer go through the lower left corners of pixels, not through their centres.
    shifted = mh.Camera.intrinsics(WIDTH, HEIGHT, camera.fx, camera.fy, camera.cx + 0.5, camera.cy - 0.5)
    picture = world.render(shifted.at(camera.position, camera.quaternion).clipped(NEAR, FAR))

    code = np.full(len(world.model.links) + 1, -1, np.int32)
    for i, link in enumerate(world.model.links):
        if link.name in names:
            body, index = names[link.name]
            code[i] = body + ((index + 1) << 24)
    ours = code[picture.segmentation]
    assert (ours == mask).mean() > 0.99
    assert (ours >= 0).mean() > 0.2
    same = ours == mask
    assert (np.abs(picture.depth - theirs)[same] < 2e-3).mean() > 0.995
    for name in BOXES:
        seen = same & (ours == names[name][0])
        assert seen.sum() > 50
        assert np.percentile(np.abs(picture.depth - theirs)[seen], 99) < 1e-4
    np.testing.assert_allclose(picture.depth[mask == -1][same[mask == -1]], FAR, rtol=1e-6)
