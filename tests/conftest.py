"""For all tests in Python."""

import os
from collections.abc import Generator

import gymnasium
import pytest

import manyhands  # noqa: F401  (registers its environments)

os.environ["MANYHANDS_PYBULLET_GUI"] = "0"  # a test that wants a page says so

_REGISTRY = dict(gymnasium.registry)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Ids stay those of `manyhands.envs` though modules of tests import panda-gym, or the drop-in for it."""
    try:
        return (yield)
    finally:
        gymnasium.registry.clear()
        gymnasium.registry.update(_REGISTRY)
