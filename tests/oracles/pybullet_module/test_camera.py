"""Pictures: sizes and types exactly, depth and segmentation of nearly all pixels."""

import numpy as np
import pytest
from bodies import ARM, add_box, pose

from benchmarks.bullet.beside import Beside

seeds = pytest.mark.parametrize("seed", range(3))
W, H = 120, 90


def scene(both: Beside, rng: np.random.Generator) -> dict[str, object]:
    """An arm and boxes, and a camera that sees them."""
    arm = both.loadURDF(ARM, useFixedBase=True)
    for joint, q in enumerate(pose(rng)):
        both.resetJointState(arm, joint, q)
    for _ in range(4):
        add_box(both, rng.uniform([-0.6, -0.6, 0], [0.6, 0.6, 0.5]).tolist(), half=0.15)
    yaw, pitch = rng.uniform(-180, 180), rng.uniform(-60, -10)
    view = both.computeViewMatrixFromYawPitchRoll([0, 0, 0.4], 2.5, yaw, pitch, 0, 2, within=1e-5)
    projection = both.computeProjectionMatrixFOV(50, W / H, 0.1, 10, within=1e-5)
    return {"width": W, "height": H, "viewMatrix": view, "projectionMatrix": projection}


def agreement(both: Beside, index: int, near: float, **options: object) -> float:
    """The share of pixels alike in slot `index` of the picture; its kind is compared by the helper."""
    pictures = both.on_each(lambda m: m.getCameraImage(**options))
    a, b = (picture[index].astype(float) for picture in pictures)
    return float(np.mean(np.abs(a - b) <= near))


def kind(picture: tuple[object, ...]) -> list[object]:
    return [*picture[:2], *((array.dtype.str, array.shape) for array in picture[2:])]


@seeds
@pytest.mark.parametrize(
    "option",
    [
        {},
        {"renderer": 65536},
        {"renderer": 131072},
        {"shadow": 1},
        {"lightDirection": [1, 1, 1]},
        {"lightColor": [1, 0.5, 0.5]},
        {"lightDistance": 2},
        {"lightAmbientCoeff": 0.3},
        {"lightDiffuseCoeff": 0.3},
        {"lightSpecularCoeff": 0.3},
    ],
    ids=str,
)
def test_pictures(both: Beside, rng: np.random.Generator, option: dict[str, object]) -> None:
    camera = scene(both, rng)
    both.getCameraImage(**camera, **option, view=kind)
    assert agreement(both, 3, 2e-3, **camera, **option) > 0.95
    assert agreement(both, 4, 0, **camera, **option) > 0.95


@seeds
def test_masks(both: Beside, rng: np.random.Generator) -> None:
    camera = scene(both, rng)
    both.getCameraImage(**camera, flags=both.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX, view=kind)
    assert agreement(both, 4, 0, **camera, flags=both.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX) > 0.95
    both.getCameraImage(**camera, flags=both.ER_NO_SEGMENTATION_MASK, view=kind)


def test_a_matrix_of_another_length_is_passed_over(both: Beside) -> None:
    both.loadURDF(ARM)
    both.getCameraImage(40, 30, [1, 2, 3], [4, 5], view=kind)
    both.getCameraImage(40, 30, view=kind)


@pytest.mark.parametrize(
    "call", [("getCameraImage",), ("getCameraImage", 40), ("getCameraImage", "a", 30), ("getCameraImage", 1.5, 30)]
)
def test_wrong_pictures(both: Beside, call: tuple[object, ...]) -> None:
    both.loadURDF(ARM)
    both.refuses(*call)
