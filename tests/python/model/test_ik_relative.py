"""Goals of one frame in another: two Pandas in one model, each checked by the forward kinematics of a lone one."""

import numpy as np
import pytest

import manyhands as mh
from manyhands import kinematics as kin

HAND = "panda_grasptarget"
LEFT, RIGHT = (0.0, 0.4, 0.0), (0.3, -0.5, 0.2)
LEFT_TURN, RIGHT_TURN = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, np.sin(0.7), np.cos(0.7))
N = 300


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


@pytest.fixture(scope="module")
def pair(panda: mh.Model) -> mh.Model:
    builder = mh.ModelBuilder()
    builder.add_model(panda, position=LEFT, quaternion=LEFT_TURN, prefix="left/")
    builder.add_model(panda, position=RIGHT, quaternion=RIGHT_TURN, prefix="right/")
    return builder.build()


def relative(panda: mh.Model, q: np.ndarray) -> np.ndarray:
    """(n, 4, 4): the right hand in the left one at q (n, 18)."""
    left = kin.matrix(LEFT, LEFT_TURN) @ kin.matrix(*kin.forward(panda, q[:, :9], HAND))
    right = kin.matrix(RIGHT, RIGHT_TURN) @ kin.matrix(*kin.forward(panda, q[:, 9:], HAND))
    return np.linalg.inv(left) @ right


def random_configurations(panda: mh.Model, n: int = N) -> np.ndarray:
    moving = [joint for joint in panda.joints if joint.iq >= 0]
    lower, upper = np.array([(joint.lower, joint.upper) for joint in moving] * 2).T
    return np.random.default_rng(0).uniform(lower, upper, (n, 18))


def test_both_arms_bring_one_hand_to_a_pose_in_the_other(panda: mh.Model, pair: mh.Model) -> None:
    goal = relative(panda, random_configurations(panda))
    position, quaternion = kin.pose(goal)
    found = kin.inverse(
        pair,
        f"right/{HAND}",
        relative_to=f"left/{HAND}",
        position=position,
        quaternion=quaternion,
        position_tolerance=1e-9,
        rotation_tolerance=1e-9,
    )
    assert found.success.mean() > 0.999
    np.testing.assert_allclose(relative(panda, found.q)[found.success], goal[found.success], atol=1e-8)
    start = pair.neutral_configuration()
    moves = (found.q != start).mean(axis=0)
    assert (moves[[*range(6), *range(9, 15)]] > 0.5).all(), "joints of both arms move"
    assert (moves[[7, 8, 16, 17]] == 0).all(), "fingers do not"


def test_an_arm_fixed_in_the_world_needs_no_second_one(panda: mh.Model, pair: mh.Model) -> None:
    """Relative to a base the goal is one of a lone arm."""
    q = random_configurations(panda)[:, :9]
    position, quaternion = kin.forward(panda, q, HAND)
    found = kin.inverse(
        pair, f"right/{HAND}", relative_to="right/panda_link0", position=position, quaternion=quaternion
    )
    reached, _ = kin.forward(panda, found.q[:, 9:], HAND)
    np.testing.assert_allclose(reached[found.success], position[found.success], atol=1e-5)
    assert found.success.mean() > 0.99
    assert (found.q[:, :9] == pair.neutral_configuration()[:9]).all()


@pytest.mark.parametrize("kind", ["direction", "look_at"])
def test_axes_and_points_are_those_of_the_other_frame(panda: mh.Model, pair: mh.Model, kind: str) -> None:
    goal = relative(panda, random_configurations(panda))
    toward = goal[:, :3, 2] if kind == "direction" else goal[:, :3, 3] + 0.3 * goal[:, :3, 2]
    found = kin.inverse(pair, f"right/{HAND}", relative_to=f"left/{HAND}", position=goal[:, :3, 3], **{kind: toward})
    reached = relative(panda, found.q)
    assert found.success.mean() > 0.999
    np.testing.assert_allclose(reached[found.success, :3, 3], goal[found.success, :3, 3], atol=1e-5)
    np.testing.assert_allclose(reached[found.success, :3, 2], goal[found.success, :3, 2], atol=2e-4)


def test_a_frame_that_does_not_move_in_the_other_is_refused(pair: mh.Model) -> None:
    with pytest.raises(ValueError, match="no joint moves frame 'right/panda_hand' relative to 'right/panda_link7'"):
        kin.inverse(pair, "right/panda_hand", relative_to="right/panda_link7", position=(0, 0, 0.1))
    with pytest.raises(KeyError, match="nowhere"):
        kin.inverse(pair, "right/panda_hand", relative_to="nowhere", position=(0, 0, 0.1))
