"""Inverse kinematics that avoids collisions, judged by the planner's exact distances."""

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import kinematics as kin
from manyhands import planning

Array = NDArray[np.float64]
HAND = "panda_grasptarget"
HOME = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03])
DOWN = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def planner() -> planning.Planner:
    """Of a Panda at a table, before a post."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = HOME
    world.add_box("table", (0.4, 0.6, 0.02), position=(0.6, 0, 0.05), fixed=True)
    world.add_cylinder("post", 0.05, 0.3, position=(0.45, 0, 0.37), fixed=True)
    return planning.Planner(world, HAND)


def reachable(planner: planning.Planner, count: int) -> tuple[Array, Array]:
    """Poses of the hand that free configurations have."""
    lower, upper = np.array([getattr(planner._core, name) for name in ("lower", "upper")])
    rows = np.random.default_rng(3).uniform(lower, upper, (20 * count, len(planner.joints)))
    return kin.forward(planner.model, planner.configuration(rows[planner.is_free(rows)][:count]), HAND)


def test_what_is_found_is_free_and_reaches(planner: planning.Planner) -> None:
    position, quaternion = reachable(planner, 200)
    careless = kin.inverse(
        planner.model, HAND, position=position, quaternion=quaternion, start=planner.configuration(planner.start)
    )
    found = kin.inverse(planner.model, HAND, position=position, quaternion=quaternion, avoid=planner)
    n = len(planner.joints)
    assert not planner.is_free(careless.q[careless.success][:, :n]).all(), "the scene asks for no care"
    assert found.success.mean() > 0.98
    assert all(planner.nearest(row).distance > 0 for row in found.q[found.success][:, :n])
    reached, _ = kin.forward(planner.model, found.q, HAND)
    np.testing.assert_allclose(reached[found.success], position[found.success], atol=1e-5)
    np.testing.assert_array_equal(found.q[:, n:], np.tile(HOME[n:], (200, 1)))  # what is not planned is as in the scene


def test_the_first_that_is_free_is_the_one_without_planner(planner: planning.Planner) -> None:
    start = planner.configuration(planner.start)
    position, quaternion = reachable(planner, 200)
    careless = kin.inverse(planner.model, HAND, position=position, quaternion=quaternion, start=start)
    found = kin.inverse(planner.model, HAND, position=position, quaternion=quaternion, avoid=planner)
    same = careless.success & planner.is_free(careless.q[:, : len(planner.joints)])
    np.testing.assert_array_equal(found.q[same], careless.q[same])


def test_a_goal_that_only_collisions_reach_says_so(planner: planning.Planner) -> None:
    inside = kin.inverse(planner.model, HAND, position=(0.45, 0.0, 0.3), quaternion=DOWN, avoid=planner)
    assert not inside.success
    assert inside.position_error < 1e-5
    assert inside.rotation_error < 1e-4
    far = kin.inverse(planner.model, HAND, position=(3.0, 0.0, 0.3), quaternion=DOWN, avoid=planner)
    assert not far.success
    assert far.position_error > 1


def test_any_goal_can_be_free(planner: planning.Planner) -> None:
    above = kin.inverse(planner.model, HAND, position=(0.45, 0.25, 0.2), direction=(0, 0, -1), avoid=planner)
    assert above.success
    assert planner.is_free(above.q[: len(planner.joints)])


def test_a_planner_that_does_not_fit_is_refused(planner: planning.Planner) -> None:
    other, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)
    with pytest.raises(ValueError, match="another model"):
        kin.inverse(other, HAND, position=(0.4, 0, 0.4), avoid=planner)
    few = planning.Planner(planner.model, joints=["panda_joint1", "panda_joint2"])
    with pytest.raises(ValueError, match="does not plan joint 'panda_joint3'"):
        kin.inverse(planner.model, HAND, position=(0.4, 0, 0.4), avoid=few)
