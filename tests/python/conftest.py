"""What several tests share: they import modules of `shared/`, and look at one policy that was learned."""

import os
import sys
from pathlib import Path

import pytest

os.environ["BROWSER"] = "true"  # human mode opens none in tests
sys.path.insert(0, str(Path(__file__).parent / "shared"))


@pytest.fixture(scope="session")
def reach_policy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a training run that learned PandaReach, in about two seconds."""
    from manyhands import cli

    runs = tmp_path_factory.mktemp("runs")
    assert cli.main(["train", "PandaReach", "--seed", "0", "--episodes", "10", "--runs", str(runs)]) == 0
    (path,) = runs.iterdir()
    return path
