"""The pictures of each task as they were when somebody looked at them and found them good.

`python tests/python/render/test_golden_pictures.py` writes them anew, to be looked at.
"""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from numpy.typing import NDArray

from manyhands.envs import ArmEnv

FOLDER = Path(__file__).parent / "golden"
TASKS = ("PandaReach", "PandaPush", "PandaSlide", "PandaPickAndPlace", "PandaStack", "PandaFlip")


def picture_of(task: str) -> NDArray[np.uint8]:
    env = ArmEnv(task, render_mode="rgb_array", render_width=180, render_height=120, render_distance=1.2)
    env.reset(seed=0)
    picture = env.render()
    assert picture is not None
    return picture


def blurred(picture: NDArray[np.floating]) -> NDArray[np.floating]:
    """Means over 3 x 3 pixels: what the eye sees of edges."""
    rows = sum(np.roll(picture, shift, 0) for shift in (-1, 0, 1)) / 3
    return sum(np.roll(rows, shift, 1) for shift in (-1, 0, 1)) / 3


@pytest.mark.parametrize("task", TASKS)
def test_pictures_are_as_they_were_found_good(task: str) -> None:
    golden = 255 * matplotlib.image.imread(FOLDER / f"{task}.png")[..., :3]
    difference = np.abs(blurred(golden) - blurred(picture_of(task).astype(np.float64)))
    assert difference.mean() < 0.5
    assert np.percentile(difference, 99.5) < 8


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name in TASKS:
        matplotlib.image.imsave(FOLDER / f"{name}.png", picture_of(name))
