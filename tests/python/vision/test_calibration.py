"""Boards that our own cameras see: their numbers, which are known, come back."""

import math

import numpy as np
import pytest

import manyhands as mh
from manyhands.vision import Chessboard, calibrate

cv2 = pytest.importorskip("cv2", reason="pip install manyhands[vision]")


def render(board: Chessboard, camera: mh.Camera) -> np.ndarray:
    world = mh.World()
    world.add_box(
        "board",
        [*(0.5 * length for length in board.size), 0.005],
        position=[0, 0, -0.005],
        colour=[1, 1, 1],
        fixed=True,
    )
    texture = {"board": board.texture()}
    return world.render(camera, look=mh.Look(shadows=False, antialiasing=3), textures=texture).colour


def project(camera: mh.Camera, points: np.ndarray) -> np.ndarray:
    X = np.linalg.inv(mh.kinematics.matrix(camera.position, camera.quaternion))
    x, y, z = (points @ X[:3, :3].T + X[:3, 3]).T
    return np.stack([camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy], axis=1)


def held(seen: mh.Camera, yaw: float, tilt: float, distance: float = 0.6) -> mh.Camera:
    """Towards the board's middle, tilted [degrees]."""
    a, b = np.radians([yaw, tilt])
    eye = distance * np.array([math.sin(b) * math.cos(a), math.sin(b) * math.sin(a), math.cos(b)])
    return seen.look_at(eye.tolist(), [0, 0, 0], up=[0, 1, 0])


def views(seen: mh.Camera) -> list[mh.Camera]:
    """From all sides, and with all sides up."""
    around = [(0, 0, 0), (20, 25, 40), (75, 35, 110), (130, 30, 190), (200, 35, 260), (260, 25, 20), (320, 38, 300)]
    placed = []
    for yaw, tilt, roll in np.radians(around):
        eye = 0.6 * np.array([math.sin(tilt) * math.cos(yaw), math.sin(tilt) * math.sin(yaw), math.cos(tilt)])
        placed.append(seen.look_at(eye.tolist(), [0.01, -0.01, 0], up=[math.cos(roll), math.sin(roll), 0]))
    return placed


def test_corners_are_where_the_camera_puts_them() -> None:
    board = Chessboard()
    for camera in views(mh.Camera.perspective(640, 480, math.radians(45))):
        found = board.find(render(board, camera))
        assert found is not None
        assert np.abs(found - project(camera, board.corners)).max() < 0.15, "pixels"


def test_a_calibration_is_the_cameras() -> None:
    board = Chessboard(columns=8, rows=5, side=0.025)
    camera = mh.Camera.intrinsics(640, 480, 610.0, 590.0, 330.0, 228.0)
    found = calibrate(board, [render(board, view) for view in views(camera)])
    assert found.error < 0.06
    K = found.lens.K
    np.testing.assert_allclose([K[0, 0], K[1, 1]], [610, 590], rtol=2e-3)
    np.testing.assert_allclose([K[0, 2], K[1, 2]], [330, 228], atol=1.5)
    other = camera.look_at([0.2, 0.15, 0.5], [0, 0, 0], up=[0, 1, 0])
    X = np.linalg.inv(mh.kinematics.matrix(other.position, other.quaternion))
    seen = cv2.projectPoints(board.corners, cv2.Rodrigues(X[:3, :3])[0], X[:3, 3], K, found.lens.distortion)[0]
    assert np.abs(seen.reshape(-1, 2) - project(other, board.corners)).max() < 1.5, "pixels, from a new place"
    for X, view in zip(found.X, views(camera), strict=True):
        truth = mh.kinematics.matrix(view.position, view.quaternion)
        np.testing.assert_allclose(X[:3, 3], truth[:3, 3], atol=2e-3)
        np.testing.assert_allclose(X[:3, :3], truth[:3, :3], atol=5e-3)


CAMERA = mh.Camera.intrinsics(640, 480, 610.0, 590.0, 330.0, 228.0)
TOO_ALIKE = {
    "the same from ahead": [held(CAMERA, 0, 0)] * 3,
    "from ahead, nearer and farther": [held(CAMERA, 0, 0, distance) for distance in (0.5, 0.6, 0.8)],
    "the same, tilted": [held(CAMERA, 0, 30)] * 4,
    "hardly tilted": [held(CAMERA, yaw, 2) for yaw in (0, 90, 180, 270)],
}


@pytest.mark.parametrize("name", TOO_ALIKE)
def test_views_that_leave_the_focal_length_open_are_refused(name: str) -> None:
    board = Chessboard(columns=8, rows=5, side=0.025)
    with pytest.raises(ValueError, match=r"leave the focal length open: .* tilt it by 20 to 45 degrees"):
        calibrate(board, [render(board, view) for view in TOO_ALIKE[name]])


@pytest.mark.parametrize("tilt", [10, 30])
def test_few_views_that_are_tilted_do(tilt: float) -> None:
    board = Chessboard(columns=8, rows=5, side=0.025)
    found = calibrate(board, [render(board, held(CAMERA, yaw, tilt)) for yaw in (0, 90, 200)])
    np.testing.assert_allclose(found.lens.K[[0, 1], [0, 1]], [610, 590], rtol=0.05)


def test_boards_and_pictures_without_sense_are_refused() -> None:
    with pytest.raises(ValueError, match="upside down"):
        Chessboard(8, 6)
    with pytest.raises(ValueError, match="side is 0"):
        Chessboard(side=0)
    nothing = np.zeros((40, 60, 3), np.uint8)
    assert Chessboard().find(nothing) is None
    with pytest.raises(ValueError, match="in 0 of 4 pictures"):
        calibrate(Chessboard(), [nothing] * 4)
    with pytest.raises(ValueError, match="the picture is float64"):
        Chessboard().find(np.zeros((40, 60)))
