"""Closed forms of six-axis arms, beside the search from many starts and forward kinematics."""

import numpy as np
import pytest

import manyhands as mh
from manyhands import kinematics as kin
from manyhands import robots


@pytest.fixture(scope="module")
def arm() -> mh.Model:
    return robots.load("six_axis")


def test_what_a_search_finds_from_anywhere_is_among_them(arm: mh.Model) -> None:
    rng = np.random.default_rng(0)
    for q in rng.uniform(-2.5, 2.5, (20, 6)):
        position, quaternion = kin.forward(arm, q, "flange")
        rows = kin.inverse_all(arm, "flange", position, quaternion, start=q)
        np.testing.assert_allclose(rows[0], q, atol=1e-6)
        reached = kin.forward(arm, rows, "flange")
        np.testing.assert_allclose(reached[0], np.tile(position, (len(rows), 1)), atol=1e-8)
        np.testing.assert_allclose(np.abs(reached[1] @ quaternion), 1, atol=1e-12)
        distances = np.linalg.norm(rows - q, axis=1)
        assert (np.diff(distances) >= 0).all()
        for start in rng.uniform(-3, 3, (10, 6)):
            found = kin.inverse(
                arm,
                "flange",
                position=position,
                quaternion=quaternion,
                start=start,
                restarts=0,
                position_tolerance=1e-9,
            )
            turns = (rows - found.q + np.pi) % (2 * np.pi) - np.pi
            assert not found.success or np.abs(turns).max(axis=1).min() < 1e-4


@pytest.mark.parametrize(
    ("q", "count"),
    [
        ([0.3, -1.0, 1.2, -0.5, 0.0, -1.0], 4),  # the fourth and sixth axis are parallel
        ([0.3, -1.0, 1.2, -0.5, np.pi, -1.0], 4),  # and as they are at the other end
        ([0.3, -1.0, 0.0, -0.5, 0.8, -1.0], None),  # stretched
        ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1),
    ],
)
def test_each_configuration_is_given_once(arm: mh.Model, q: list[float], count: int | None) -> None:
    position, quaternion = kin.forward(arm, q, "flange")
    rows = kin.inverse_all(arm, "flange", position, quaternion)
    apart = np.abs((rows[:, None] - rows + np.pi) % (2 * np.pi) - np.pi).max(axis=2)
    assert (apart + np.eye(len(rows)) > 1e-5).all(), rows
    assert len(rows) == count if count is not None else len(rows) > 1
    np.testing.assert_allclose(kin.forward(arm, rows, "flange")[0], np.tile(position, (len(rows), 1)), atol=1e-7)


def test_joints_that_do_not_move_the_frame_are_brought_within_limits() -> None:
    """A gripper's jaw that the start has ten metres off."""
    held = robots.load("six_axis", gripper="parallel")
    jaw = held.joint("gripper/jaw_joint")
    start = held.initial_configuration()
    position, quaternion = kin.forward(held, start, "flange")
    start[jaw.iq] = 10.0
    inside = (
        kin.inverse_all(held, "flange", position, quaternion, start=start)[0],
        kin.inverse(held, "flange", position=position, quaternion=quaternion, start=start).q,
        kin.inverse(held, "flange", position=[position, [9, 9, 9]], start=start).q[1],  # out of reach, too
    )
    for q in inside:
        assert q[jaw.iq] == jaw.upper
    free = kin.inverse(held, "flange", position=position, quaternion=quaternion, start=start, respect_limits=False)
    assert free.success and free.q[jaw.iq] == 10.0


def test_angles_stay_in_the_turn_of_the_start(arm: mh.Model) -> None:
    q = np.array([0.3, -1.0, 1.2, -0.5, 0.8, -1.0])
    position, quaternion = kin.forward(arm, q, "flange")
    wound = q.copy()
    wound[5] += 2 * np.pi
    joints = [joint for joint in arm.joints if joint.iq >= 0]
    rows = kin.inverse_all(arm, "flange", position, quaternion, start=wound)
    limits = np.array([(joint.lower, joint.upper) for joint in joints])
    assert ((rows >= limits[:, 0]) & (rows <= limits[:, 1])).all()
    np.testing.assert_allclose(rows[0], wound, atol=1e-6)


def test_what_has_no_closed_form_or_no_solution_says_so(arm: mh.Model) -> None:
    assert kin.inverse_all(arm, "flange", [5, 0, 0], [0, 0, 0, 1]).shape == (0, 6)
    panda = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]
    with pytest.raises(ValueError, match="no six-axis arm"):
        kin.inverse_all(panda, "panda_hand", [0.4, 0, 0.4], [1, 0, 0, 0])
    with pytest.raises(ValueError, match="one pose"):
        kin.inverse_all(arm, "flange", [[0.4, 0, 0.4]], [1, 0, 0, 0])
    with pytest.raises(ValueError, match="start has shape"):
        kin.inverse_all(arm, "flange", [0.4, 0, 0.4], [1, 0, 0, 0], start=[0.0])
    with pytest.raises(KeyError):
        kin.inverse_all(arm, "nowhere", [0.4, 0, 0.4], [1, 0, 0, 0])
