"""Inverse kinematics from Python: what it finds is checked by forward kinematics."""

from typing import Any

import numpy as np
import pytest

import manyhands as mh

HAND = "panda_grasptarget"


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"))[0]


def test_reaches_poses_within_the_limits(panda: mh.Model) -> None:
    rng = np.random.default_rng(0)
    lower = np.array([joint.lower for joint in panda.joints if joint.iq >= 0])
    upper = np.array([joint.upper for joint in panda.joints if joint.iq >= 0])
    position, quaternion = mh.dynamics.frame_pose(panda, rng.uniform(lower, upper, (500, panda.nq)), HAND)
    found = mh.inverse_kinematics(panda, HAND, position, quaternion)
    assert found.success.mean() >= 0.995
    assert ((found.q >= lower) & (found.q <= upper)).all()
    reached, _ = mh.dynamics.frame_pose(panda, found.q, HAND)
    assert np.abs(reached - position)[found.success].max() < 1e-5


def test_tolerances_finer_than_single_precision_are_met(panda: mh.Model) -> None:
    rng = np.random.default_rng(0)
    lower = np.array([joint.lower for joint in panda.joints if joint.iq >= 0])
    upper = np.array([joint.upper for joint in panda.joints if joint.iq >= 0])
    position, quaternion = mh.dynamics.frame_pose(panda, rng.uniform(lower, upper, (500, panda.nq)), HAND)
    found = mh.inverse_kinematics(
        panda, HAND, position, quaternion, position_tolerance=1e-11, rotation_tolerance=1e-11, restarts=100
    )
    assert found.success.mean() >= 0.99
    reached, _ = mh.dynamics.frame_pose(panda, found.q, HAND)
    assert np.abs(reached - position)[found.success].max() < 1e-11


def test_one_pose_has_no_rows_and_the_far_side_of_the_room_is_out_of_reach(panda: mh.Model) -> None:
    near = mh.inverse_kinematics(panda, HAND, [0.4, 0.1, 0.3], [1, 0, 0, 0])
    assert near.q.shape == (panda.nq,)
    assert near.success
    far = mh.inverse_kinematics(panda, HAND, [3.0, 0, 0.3], [1, 0, 0, 0])
    assert not far.success
    assert far.position_error > 1.5


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (([0, 0], [1, 0, 0, 0]), "position has shape"),
        (([[0, 0, 0]], [1, 0, 0, 0]), "as many rows"),
        (([0, 0, np.nan], [1, 0, 0, 0]), "finite"),
        (([0, 0, 0], [0, 0, 0, 0]), "quaternion is shorter than 1e-06"),
        (([0, 0, 0], [1e-7, 0, 0, 1e-7]), "quaternion is shorter than 1e-06"),
    ],
)
def test_wrong_targets_are_refused(panda: mh.Model, arguments: tuple[list[float], list[float]], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        mh.inverse_kinematics(panda, HAND, *arguments)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("start", np.full(9, np.nan)),
        ("start", [np.inf] * 9),
        ("start", [0.0]),
        ("position_tolerance", 0.0),
        ("position_tolerance", np.nan),
        ("rotation_tolerance", -1e-4),
        ("restarts", -1),
        ("restarts", 2.5),
        ("restarts", True),
        ("restarts", 2**31),
        ("seed", -1),
        ("seed", 0.5),
        ("seed", "0"),
        ("seed", 2**64),
    ],
)
def test_wrong_settings_are_refused_by_name(panda: mh.Model, name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"{name} (is|must be|has)"):
        mh.inverse_kinematics(panda, HAND, [0.4, 0.1, 0.3], [1, 0, 0, 0], **{name: value})


def test_coordinates_that_do_not_move_the_frame_stay_as_in_start(panda: mh.Model) -> None:
    start = panda.neutral_configuration()
    for fingers, within in ((0.03, 0.03), (0.5, 0.04), (-0.5, 0.0)):  # of 0 to 0.04
        start[-2:] = fingers
        found = mh.inverse_kinematics(panda, "panda_hand", [0.4, 0.1, 0.4], [1, 0, 0, 0], start=start, seed=2**64 - 1)
        assert found.success
        assert (found.q[-2:] == within).all()
    free = mh.inverse_kinematics(panda, "panda_hand", [0.4, 0.1, 0.4], [1, 0, 0, 0], start=start, respect_limits=False)
    assert (free.q[-2:] == -0.5).all()


def test_an_unknown_frame_is_refused_by_name(panda: mh.Model) -> None:
    with pytest.raises(KeyError, match="no_such_frame"):
        mh.inverse_kinematics(panda, "no_such_frame", [0, 0, 0], [1, 0, 0, 0])
