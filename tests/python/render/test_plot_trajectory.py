"""Pictures of trajectories."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import manyhands as mh
from manyhands import planning
from manyhands.plots import plot_trajectory


def test_a_trajectory_beside_its_limits(tmp_path: Path) -> None:
    model = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]
    motion = planning.quintic([0, 1, 2], np.random.default_rng(0).uniform(0, 0.03, (3, model.nq)))
    plain = plot_trajectory(motion, tmp_path / "plain.png")
    limited = plot_trajectory(motion, tmp_path / "motion.png", velocity=0.1, torque=[87.0] * 9, model=model)
    assert np.asarray(Image.open(limited)).shape[0] >= np.asarray(Image.open(plain)).shape[0] > 300
    names = [joint.name for joint in model.joints if joint.iq >= 0]
    text = plot_trajectory(motion, tmp_path / "motion.html", velocity=0.1, model=model, names=names).read_text()
    assert "Joint accelerations" in text and "panda_joint3" in text and '"dash":"dash"' in text


def test_what_does_not_fit_is_refused(tmp_path: Path) -> None:
    motion = planning.cubic([0, 1], [[0.0], [1.0]])
    with pytest.raises(ValueError, match=r"expected \.png or \.html"):
        plot_trajectory(motion, tmp_path / "motion.pdf")
    with pytest.raises(ValueError, match="2 names for 1 joints"):
        plot_trajectory(motion, tmp_path / "motion.png", names=["a", "b"])
    with pytest.raises(ValueError, match="velocity has shape"):
        plot_trajectory(motion, tmp_path / "motion.png", velocity=[1, 2])
