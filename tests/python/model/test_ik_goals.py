"""Goals of inverse kinematics: what is found is checked by forward kinematics, postures by another optimiser."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import manyhands as mh
from manyhands import kinematics as kin

HAND = "panda_grasptarget"
HOME = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8, 0.0, 0.0])
N = 300


@pytest.fixture(scope="module")
def panda() -> mh.Model:
    return mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)[0]


def limits(model: mh.Model) -> tuple[np.ndarray, np.ndarray]:
    moving = [joint for joint in model.joints if joint.iq >= 0]
    return np.array([joint.lower for joint in moving]), np.array([joint.upper for joint in moving])


def reachable(model: mh.Model, n: int = N) -> dict[str, np.ndarray]:
    """Goals that random configurations meet: all that `inverse` knows, for the hand's z axis."""
    position, quaternion = kin.forward(model, np.random.default_rng(0).uniform(*limits(model), (n, model.nq)), HAND)
    z = kin.matrix(position, quaternion)[:, :3, 2]
    return {"position": position, "quaternion": quaternion, "direction": 3 * z, "look_at": position + 0.4 * z}


def errors(model: mh.Model, q: np.ndarray, goal: dict[str, np.ndarray]) -> np.ndarray:
    """(n, 2) in position and rotation, by forward kinematics."""
    position, quaternion = kin.forward(model, q, HAND)
    z = kin.matrix(position, quaternion)[:, :3, 2]
    found = np.zeros((len(q), 2))
    if "position" in goal:
        found[:, 0] = np.linalg.norm(position - goal["position"], axis=1)
    if "quaternion" in goal:
        found[:, 1] = 2 * np.arccos(np.clip(np.abs(np.sum(quaternion * goal["quaternion"], 1)), 0, 1))
    way = goal["look_at"] - position if "look_at" in goal else goal.get("direction")
    if way is not None:
        found[:, 1] = np.arctan2(np.linalg.norm(np.cross(z, way), axis=1), np.sum(z * way, axis=1))
    return found


GOALS = [
    ("position",),
    ("quaternion",),
    ("direction",),
    ("look_at",),
    ("position", "quaternion"),
    ("position", "direction"),
    ("position", "look_at"),
]


@pytest.mark.parametrize("with_posture", [False, True], ids=["any", "posture"])
@pytest.mark.parametrize("names", GOALS, ids="+".join)
def test_goals_are_reached_within_the_limits(panda: mh.Model, names: tuple[str, ...], with_posture: bool) -> None:
    everything = reachable(panda)
    goal = {name: everything[name] for name in names}
    found = kin.inverse(panda, HAND, **goal, posture=HOME if with_posture else None)
    assert found.success.mean() >= 0.99
    lower, upper = limits(panda)
    assert ((found.q >= lower) & (found.q <= upper)).all()
    by_hand = errors(panda, found.q, goal)
    assert (by_hand[found.success] <= [1e-5 + 1e-12, 1e-4 + 1e-7]).all()
    np.testing.assert_allclose(found.position_error, by_hand[:, 0], atol=1e-9)
    np.testing.assert_allclose(found.rotation_error, by_hand[:, 1], atol=1e-7)


def test_a_pose_is_what_inverse_kinematics_finds(panda: mh.Model) -> None:
    goal = reachable(panda)
    ours = kin.inverse(panda, HAND, position=goal["position"], quaternion=goal["quaternion"])
    for a, b in zip(ours, kin.inverse_kinematics(panda, HAND, goal["position"], goal["quaternion"]), strict=True):
        np.testing.assert_array_equal(a, b)


def test_any_axis_of_the_frame_can_point(panda: mh.Model) -> None:
    axis = np.array([1.0, 2.0, 2.0])
    found = kin.inverse(panda, HAND, position=[0.4, 0.1, 0.4], direction=[0, 0, -1], axis=axis)
    assert found.success
    assert found.q.shape == (9,)
    turned = kin.matrix(*kin.forward(panda, found.q, HAND))[:3, :3] @ axis
    np.testing.assert_allclose(turned / 3, [0, 0, -1], atol=1e-4)


def test_one_goal_holds_for_all_rows(panda: mh.Model) -> None:
    positions = reachable(panda, 5)["position"]
    one = kin.inverse(panda, HAND, position=positions, look_at=[0.5, 0, 0])
    each = kin.inverse(panda, HAND, position=positions, look_at=np.tile([0.5, 0, 0], (5, 1)))
    np.testing.assert_array_equal(one.q, each.q)


def test_a_posture_is_as_near_as_another_optimiser_finds_it(panda: mh.Model) -> None:
    """SLSQP from our solution, with analytic gradients: no nearer configuration reaches the position."""
    rng = np.random.default_rng(1)
    lower, upper = limits(panda)
    q = np.clip(HOME + rng.uniform(-0.8, 0.8, (10, 9)), lower, upper)
    positions = kin.forward(panda, q, HAND)[0]
    found = kin.inverse(panda, HAND, position=positions, posture=HOME)
    assert found.success.all()
    for goal, ours in zip(positions, found.q, strict=True):
        reaches = {
            "type": "eq",
            "fun": lambda x, goal=goal: kin.forward(panda, x, HAND)[0] - goal,
            "jac": lambda x: kin.jacobian(panda, x, HAND)[3:],
        }
        best: Any = minimize(
            lambda x: np.sum((x - HOME) ** 2), ours, jac=lambda x: 2 * (x - HOME), method="SLSQP",
            constraints=[reaches], bounds=list(zip(lower, upper, strict=True)), options={"ftol": 1e-12},
        )  # fmt: skip
        assert best.success
        # A tolerance of 1e-5 m in position is worth as much of the distance, times what joints move the hand by.
        assert np.linalg.norm(ours - HOME) <= np.sqrt(best.fun) + 1e-4
        np.testing.assert_allclose(ours, best.x, atol=5e-3)


def test_weights_decide_what_is_left_of_a_goal_out_of_reach(panda: mh.Model) -> None:
    goal = {"position": [0.0, 0.0, 1.6], "direction": [0.0, 0.0, -1.0]}  # the hand cannot look down up there
    placed = kin.inverse(panda, HAND, **goal, rotation_weight=0.01)
    turned = kin.inverse(panda, HAND, **goal, position_weight=0.01)
    assert not placed.success
    assert not turned.success
    assert placed.position_error < turned.position_error
    assert turned.rotation_error < placed.rotation_error


def test_a_point_too_far_to_touch_can_be_looked_at(panda: mh.Model) -> None:
    assert kin.inverse(panda, HAND, look_at=[50.0, 20.0, 30.0]).success
    assert not kin.inverse(panda, HAND, position=[50.0, 20.0, 30.0]).success


def test_a_point_at_the_frame_itself_cannot_be_looked_at(panda: mh.Model) -> None:
    found = kin.inverse(panda, HAND, position=[0.4, 0.1, 0.4], look_at=[0.4, 0.1, 0.4], restarts=3)
    assert np.isfinite(found.q).all()
    assert not (found.success and found.position_error == 0)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({}, "there is no goal; give position"),
        ({"quaternion": [0, 0, 0, 1], "look_at": [1, 0, 0]}, "different goals of orientation"),
        ({"position": [0, 0]}, r"position has shape \(2,\)"),
        ({"position": np.zeros((1, 1, 3))}, r"position has shape \(1, 1, 3\); expected \(3,\) or \(n, 3\)"),
        ({"position": np.zeros((2, 3)), "direction": np.ones((3, 3))}, "position 2 and direction 3 rows"),
        ({"position": [0, 0, np.nan]}, "position must be finite"),
        ({"direction": [0, 0, 0]}, "direction is shorter"),
        ({"look_at": [1, 0, np.inf]}, "look_at must be finite"),
        ({"direction": [0, 0, 1], "axis": [0, 0, 0]}, "axis is shorter"),
        ({"position": [0, 0, 0], "posture": [0.0]}, r"posture has shape \(1,\); expected \(9,\)"),
        ({"position": [0, 0, 0], "posture": [np.nan] * 9}, "posture must be finite"),
        ({"position": [0, 0, 0], "position_weight": 0}, "position_weight is 0"),
        ({"position": [0, 0, 0], "rotation_weight": np.nan}, "rotation_weight is nan"),
        ({"position": [0, 0, 0], "position_weight": np.inf}, "position_weight is inf"),
    ],
)
def test_goals_without_sense_are_refused(panda: mh.Model, arguments: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        kin.inverse(panda, HAND, **arguments)


def test_an_unknown_frame_is_refused(panda: mh.Model) -> None:
    with pytest.raises(KeyError, match="panda_hand"):
        kin.inverse(panda, "hand", position=[0, 0, 0])
