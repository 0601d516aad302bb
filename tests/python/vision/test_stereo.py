"""Depth from two of our own cameras, whose depth pictures are the truth."""

import math

import numpy as np
import pytest

import manyhands as mh
from manyhands.vision import Chessboard, Lens, StereoRig

pytest.importorskip("cv2", reason="pip install manyhands[vision]")

BASELINE = 0.08


def scene() -> tuple[mh.World, dict[str, mh.Texture]]:
    """Things on a floor, all full of pattern: what has none cannot be matched."""
    world = mh.World()
    world.add_plane("floor")
    world.add_box("crate", [0.15, 0.1, 0.1], position=[0.0, 0.0, 0.1])
    world.add_box("tower", [0.06, 0.06, 0.2], position=[-0.1, 0.3, 0.2])
    noise = np.random.default_rng(0).integers(0, 255, (256, 256, 3)).astype(np.uint8)
    return world, {"floor": mh.Texture(noise), "crate": mh.Texture(noise), "tower": mh.Texture(noise)}


def cameras(turn: float = 0.0) -> tuple[mh.Camera, mh.Camera]:
    """Side by side, the right one turned in by an angle [rad]."""
    seen = mh.Camera.perspective(320, 240, math.radians(50))
    left = seen.look_at([-0.04, -1.0, 0.7], [-0.04, 0.0, 0.1])
    right = seen.look_at([0.04, -1.0, 0.7], [0.04 - math.tan(turn), 0.0, 0.1])
    return left, right


@pytest.mark.parametrize("turn", [0.0, 0.05])
def test_depth_is_that_of_the_cameras(turn: float) -> None:
    world, textures = scene()
    left, right = cameras(turn)
    look = mh.Look(shadows=False)
    views = [world.render(camera, look=look, textures=textures) for camera in (left, right)]
    rig = StereoRig(left, right)
    assert rig.baseline == pytest.approx(BASELINE, rel=1e-6)
    disparity = rig.disparity(*rig.rectify(views[0].colour, views[1].colour))
    seen = np.isfinite(disparity)
    assert seen[:, 64:].mean() > 0.8
    points = rig.points(disparity)[seen]
    np.testing.assert_allclose(
        np.linalg.inv(rig.X_rectified)[2, :3] @ points.T + np.linalg.inv(rig.X_rectified)[2, 3],
        rig.depth(disparity)[seen], rtol=1e-4,
    )  # fmt: skip
    surface = views[0].point_cloud().reshape(240, 320, 3)
    X = np.linalg.inv(rig.left.X)
    inside = points @ X[:3, :3].T + X[:3, 3]
    pixels = inside @ rig.left.K.T
    columns, rows = np.floor(pixels[:, :2] / pixels[:, 2:]).astype(int).T
    there = (columns >= 0) & (columns < 320) & (rows >= 0) & (rows < 240)
    truth = np.full(len(points), np.nan)
    truth[there] = (surface[rows[there], columns[there]] @ X[:3, :3].T + X[:3, 3])[:, 2]
    near = truth < 1.6  # [m]; far away a pixel is much
    assert near.mean() > 0.5
    off = np.abs(inside[near, 2] - truth[near])
    tenth_of_a_pixel = 0.1 * np.median(truth[near]) ** 2 / (rig.focus * rig.baseline)
    assert np.median(off) < 2 * tenth_of_a_pixel
    assert (off < 0.04).mean() > 0.95, "beside edges, half-seen things are matched with their neighbours"


def bent(picture: np.ndarray, lens: Lens, k1: float) -> np.ndarray:
    """What a lens with x (1 + k1 r²) makes of a straight picture: the nearest of its pixels."""
    height, width = picture.shape[:2]
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    K = lens.K
    bent_x, bent_y = (columns - K[0, 2]) / K[0, 0], (rows - K[1, 2]) / K[1, 1]
    x, y = bent_x, bent_y
    for _ in range(30):
        factor = 1 + k1 * (x * x + y * y)
        x, y = bent_x / factor, bent_y / factor
    row = np.clip(np.floor(y * K[1, 1] + K[1, 2]), 0, height - 1).astype(int)
    column = np.clip(np.floor(x * K[0, 0] + K[0, 2]), 0, width - 1).astype(int)
    return picture[row, column]


def test_lenses_that_bend_are_made_straight() -> None:
    """The corners of a board lie in the rectified picture where a straight camera at the rectified pose has them."""
    board, k1 = Chessboard(), -0.25
    world = mh.World()
    world.add_box("board", [*(0.5 * length for length in board.size), 0.01], position=[0, 0, -0.01], colour=[1, 1, 1])
    seen = mh.Camera.perspective(1280, 960, math.radians(45))
    left = seen.look_at([0.1, -0.2, 0.5], [0.02, -0.02, 0], up=[0, 1, 0])
    right = seen.look_at([0.18, -0.2, 0.5], [0.05, 0.0, 0], up=[0, 1, 0])
    straight = world.render(left, look=mh.Look(antialiasing=3), textures={"board": board.texture()}).colour
    lens = Lens.of(left)
    rig = StereoRig(Lens(lens.size, lens.K, lens.X, np.array([k1, 0, 0, 0, 0])), right)
    picture = bent(straight, lens, k1)
    found, as_seen, without = (board.find(p) for p in (rig.rectify(picture, picture)[0], picture, straight))
    assert found is not None and as_seen is not None and without is not None
    assert np.abs(as_seen - without).max() > 5, "pixels: it is not straight"
    X = np.linalg.inv(rig.X_rectified)
    x, y, z = (board.corners @ X[:3, :3].T + X[:3, 3]).T
    centre = 0.5 - rig.Q[:2, 3]
    expected = np.stack([x / z, y / z], axis=1) * rig.focus + centre
    off = found - expected  # the bent picture has whole pixels only
    assert np.abs(off.mean(0)).max() < 0.1
    assert np.abs(off).max() < 1.0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"disparities": 40}, "multiple of 16"),
        ({"block": 4}, "odd"),
        ({"disparities": 0}, "16 or more"),
        ({"disparities": 320}, "below the width, 320"),
    ],
)
def test_settings_without_sense_are_refused(arguments: dict[str, int], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        StereoRig(*cameras(), **arguments)


def test_pairs_and_pictures_that_do_not_fit_are_refused() -> None:
    left, right = cameras()
    with pytest.raises(ValueError, match="to the right"):
        StereoRig(right, left)
    facing = left.look_at([0.04, 1.0, 0.7], [0.04, 0.0, 0.1])
    rolled = right.look_at([0.04, -1.0, 0.7], [0.04, 0.0, 0.1], up=[0, 0, -1])
    for other, angle in ((facing, "1[0-9]{2}"), (rolled, "180")):
        with pytest.raises(ValueError, match=f"turned by {angle} degrees; expected 45"):
            StereoRig(left, other)
    seen = Lens.of(right)
    with pytest.raises(ValueError, match="X is no rigid motion"):
        Lens(seen.size, seen.K, seen.X @ np.diag([-1.0, 1, 1, 1]))
    with pytest.raises(ValueError, match="focal lengths above 0"):
        Lens(seen.size, np.diag([-1.0, 1, 1]), seen.X)
    with pytest.raises(ValueError, match="distortion has 3 numbers"):
        Lens(seen.size, seen.K, seen.X, np.zeros(3))
    with pytest.raises(ValueError, match="one size"):
        StereoRig(left, mh.Camera.perspective(100, 100, 1.0))
    with pytest.raises(ValueError, match="mounted on 'hand'"):
        Lens.of(left.at([0, 0, 0], [0, 0, 0, 1], frame="hand"))
    with pytest.raises(ValueError, match=r"left is float64 of shape \(240, 320\)"):
        StereoRig(left, right).disparity(np.zeros((240, 320)), np.zeros((240, 320)))
