"""Workspaces: what an arm of known reach covers, and their pictures."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import manyhands as mh
from manyhands import kinematics as kin
from manyhands.plots import plot_workspace


def slider(lower: float = -0.5, upper: float = 0.5) -> mh.Model:
    """A hinge without limits, 1 m from it a rail along the arm."""
    builder = mh.ModelBuilder("crane")
    builder.add_link("boom", mass=1.0)
    builder.add_joint("hinge", "continuous", "world", "boom", axis=(0, 0, 1), armature=0.1)
    builder.add_link("hook", mass=1.0)
    builder.add_joint("rail", "prismatic", "boom", "hook", position=(1, 0, 0), axis=(1, 0, 0), lower=lower, upper=upper)
    return builder.build()


def test_a_crane_covers_a_ring_and_is_best_far_out() -> None:
    found = kin.workspace(slider(), "hook", 5000, seed=1)
    radius = np.linalg.norm(found.position, axis=1)
    assert 0.5 <= radius.min() < 0.51 and 1.49 < radius.max() <= 1.5
    angle = np.arctan2(found.position[:, 1], found.position[:, 0])
    assert np.histogram(angle, 8, (-np.pi, np.pi))[0].min() > 500
    reached, _ = kin.forward(slider(), found.q, "hook")
    np.testing.assert_array_equal(reached, found.position)
    assert (found.measure == 0).all()  # it never leaves its plane
    again = kin.workspace(slider(), "hook", 5000, seed=1)
    np.testing.assert_array_equal(again.q, found.q)


def test_limits_bound_what_is_drawn() -> None:
    model = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]
    found = kin.workspace(model, "panda_grasptarget", 2000)
    moving = [joint for joint in model.joints if joint.iq >= 0]
    assert (found.q >= [joint.lower for joint in moving]).all()
    assert (found.q <= [joint.upper for joint in moving]).all()
    best = kin.manipulability(model, found.q[found.measure.argmax()], "panda_grasptarget")
    assert best.measure == found.measure.max() > 0.1


def test_pictures(tmp_path: Path) -> None:
    model = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]
    found = kin.workspace(model, "panda_grasptarget", 3000)
    picture = np.asarray(Image.open(plot_workspace(found, tmp_path / "reach.png")).convert("RGB"))
    assert picture.shape[1] > 1000 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 100
    text = plot_workspace(found, tmp_path / "reach.html").read_text()
    assert "Where panda_grasptarget can be" in text and '<script src="http' not in text
    with pytest.raises(ValueError, match="expected"):
        plot_workspace(found, tmp_path / "reach.pdf")


def test_what_has_no_bounds_is_refused() -> None:
    with pytest.raises(ValueError, match="'rail' slides without limits"):
        kin.workspace(slider(-np.inf, np.inf), "hook")
    with pytest.raises(ValueError, match="samples is 0"):
        kin.workspace(slider(), "hook", 0)
    with pytest.raises(ValueError, match="seed is -1"):
        kin.workspace(slider(), "hook", 10, seed=-1)
    with pytest.raises(KeyError, match="hook"):
        kin.workspace(slider(), "claw", 10)
