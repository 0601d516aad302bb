"""Inverse kinematics from Python: what it finds is checked by forward kinematics."""

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
        (([0, 0, 0], [0, 0, 0, 0]), "no quaternion 0"),
    ],
)
def test_wrong_targets_are_refused(panda: mh.Model, arguments: tuple[list[float], list[float]], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        mh.inverse_kinematics(panda, HAND, *arguments)


def test_an_unknown_frame_is_refused_by_name(panda: mh.Model) -> None:
    with pytest.raises(KeyError, match="no_such_frame"):
        mh.inverse_kinematics(panda, "no_such_frame", [0, 0, 0], [1, 0, 0, 0])
