"""`python -m benchmarks.ik`: a few poses of two arms, and that its judge tells right from wrong."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[3]))

pytest.importorskip("rich")

from benchmarks.ik.__main__ import main
from benchmarks.ik.arms import TOLERANCE, arms, errors, reachable, solved


def test_a_small_run_solves_nearly_all(tmp_path: Path) -> None:
    out = tmp_path / "ik.json"
    few = ["--poses", "200", "--singles", "3", "--repeats", "1", "--beside", "0"]
    main(["--arms", "seven_axis", "scara", *few, "--out", str(out)])
    figures = json.loads(out.read_text())["arms"]
    assert [f["arm"] for f in figures] == ["seven_axis", "scara"]
    for f in figures:
        assert f["solved"] + len(f["failures"]) == f["poses"] == 200
        assert f["solved"] >= 199
        assert min(f["rate"], f["single"], f["single_nearby"], f["core_nearby"]) > 0


def test_the_judge_knows_errors_and_limits() -> None:
    arm = next(arm for arm in arms() if arm.name == "panda")
    poses = reachable(arm, 20)
    assert solved(arm, poses, poses.q).all()
    off = poses.q.copy()
    off[:, 6] += 1e-3  # the last joint turns the hand about its own axis
    position, rotation = errors(arm, poses, off)
    np.testing.assert_allclose(rotation, 1e-3, atol=1e-9)
    assert (position < TOLERANCE).all()
    assert not solved(arm, poses, off).any()
    around = poses.q.copy()
    around[:, 0] += 2 * np.pi  # the same pose, beyond the limits
    assert not solved(arm, poses, around).any()
