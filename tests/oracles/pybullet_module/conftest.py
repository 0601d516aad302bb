"""A client of each module for each test. Without the real PyBullet there is nothing to compare with."""

import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from benchmarks.bullet.calls import TABLE, rows_of

sys.path.insert(0, str(Path(__file__).parent))  # bodies.py

collect_ignore_glob = [] if find_spec("pybullet") and find_spec("pybullet_data") else ["test_*.py"]


@pytest.fixture
def both() -> Iterator["Beside"]:  # noqa: F821 (imported where PyBullet is)
    """manyhands.pybullet and the real module as one."""
    from benchmarks.bullet.beside import Beside

    clients = Beside()
    yield clients
    unseen = clients.unseen()
    clients.close()
    assert not unseen, f"no result was compared after {unseen}"


@pytest.fixture(scope="session", autouse=True)
def table_is_whole(request: pytest.FixtureRequest) -> Iterator[None]:
    """docs/pybullet_coverage.md tells all that these tests compare."""
    yield
    if request.config.getoption("no_table", default=False) or request.session.testsfailed:
        return
    from benchmarks.bullet.beside import RECORD, given

    told = rows_of(TABLE.read_text(encoding="utf-8"))
    less = {name: given(name, one) - told.get(name, set()) for name, one in RECORD.items()}
    missing = {name: options for name, options in less.items() if options or name not in told}
    assert not missing, f"{TABLE.name} lacks {missing}; write it: python -m benchmarks.bullet calls"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Without a look at the table, which is about to be written."""
    parser.addoption("--no-table", action="store_true", help="do not compare with docs/pybullet_coverage.md")


@pytest.fixture
def rng(seed: int) -> np.random.Generator:
    """Random numbers of a test's own."""
    return np.random.default_rng(seed)
