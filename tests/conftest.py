"""For all tests in Python."""

import os
from collections.abc import Generator, Iterator

import gymnasium
import pytest

import manyhands  # noqa: F401  (registers its environments)
import manyhands.pybullet as p

os.environ["MANYHANDS_PYBULLET_GUI"] = "0"  # a test that wants a page says so

MOST_CLIENTS = 1024  # that there can be

_REGISTRY = dict(gymnasium.registry)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Ids stay those of `manyhands.envs` though modules of tests import panda-gym, or the drop-in for it."""
    try:
        return (yield)
    finally:
        gymnasium.registry.clear()
        gymnasium.registry.update(_REGISTRY)


@pytest.fixture(scope="module", autouse=True)
def no_client_is_left() -> Iterator[None]:
    """What a module of tests leaves connected would be the next one's first client."""
    yield
    for client in range(MOST_CLIENTS):
        if p.isConnected(client):
            p.disconnect(client)
