"""What the tests of the viewer share."""

from collections.abc import Iterator

import pytest
from viewed import falling_ball

from manyhands.viewer import Viewer


@pytest.fixture(scope="module")
def here() -> Iterator[Viewer]:
    with Viewer(falling_ball(), port=18410, announce=False) as viewer:
        yield viewer
