"""The drop-in side by side with panda-gym 3.0.7 itself, on the same seeds and actions."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from manyhands.panda_gym import registration
from manyhands.panda_gym.pybullet import PyBullet

panda_tasks = pytest.importorskip("panda_gym.envs.panda_tasks")
theirs_pybullet = pytest.importorskip("panda_gym.pybullet")

ARM = range(7)
SEEDS = 6
Array = NDArray[np.float64]


@contextmanager
def repaired(task: str) -> Iterator[Any]:
    """panda-gym's environment with two of its faults mended as here: links are read as they are now, and the fingers
    move together."""
    env = getattr(panda_tasks, f"Panda{task}Env")()
    sim, client = env.sim, env.sim.physics_client
    panda = sim._bodies_idx["panda"]

    def link_state(body: str, link: int) -> Any:
        return client.getLinkState(sim._bodies_idx[body], link, computeLinkVelocity=True, computeForwardKinematics=True)

    sim.get_link_position = lambda body, link: np.array(link_state(body, link)[0])
    sim.get_link_velocity = lambda body, link: np.array(link_state(body, link)[6])
    gear = client.createConstraint(panda, 9, panda, 10, client.JOINT_GEAR, [1, 0, 0], [0, 0, 0], [0, 0, 0])
    client.changeConstraint(gear, gearRatio=-1, erp=0.1, maxForce=1000)
    try:
        yield env
    finally:
        env.close()


def loaded(simulation: Any) -> Any:
    simulation.loadURDF("panda", fileName="franka_panda/panda.urdf", basePosition=[0, 0, 0], useFixedBase=True)
    return simulation


@pytest.mark.parametrize("link", [3, 6, 8, 9, 11])
def test_inverse_kinematics_is_pybullets(link: int) -> None:
    ours, theirs = loaded(PyBullet()), loaded(theirs_pybullet.PyBullet())
    rng = np.random.default_rng(link)
    for _ in range(20):
        angles = np.array([0, 0.41, 0, -1.85, 0, 2.26, 0.79]) + rng.uniform(-0.3, 0.3, 7)
        for sim in (ours, theirs):
            sim.set_joint_angles("panda", ARM, angles)
        position = ours.get_link_position("panda", link) + rng.uniform(-0.1, 0.1, 3)
        orientation = ours.get_link_orientation("panda", link) + rng.uniform(-0.2, 0.2, 4)
        orientation /= np.linalg.norm(orientation)
        expected = theirs.inverse_kinematics("panda", link, position, orientation)
        np.testing.assert_allclose(ours.inverse_kinematics("panda", link, position, orientation), expected, atol=1e-6)
    theirs.close()


def test_links_are_where_pybullet_has_them() -> None:
    ours, theirs = loaded(PyBullet()), loaded(theirs_pybullet.PyBullet())
    angles = [0.3, 0.5, -0.2, -1.7, 0.4, 2.0, 0.9]
    for sim in (ours, theirs):
        sim.set_joint_angles("panda", ARM, angles)
    for link in range(12):
        np.testing.assert_allclose(
            ours.get_link_position("panda", link), theirs.get_link_position("panda", link), atol=1e-6
        )
        one, other = ours.get_link_orientation("panda", link), theirs.get_link_orientation("panda", link)
        assert abs(one @ other) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(ours.get_base_position("panda"), theirs.get_base_position("panda"), atol=1e-6)
    theirs.close()


def grasp(obs: Any, t: int) -> Array:
    """Hovers above the cube, goes down, closes the gripper, carries."""
    hand, cube = obs["observation"][:3], obs["observation"][7:10]
    if t < 20:
        above = cube - hand + [0, 0, 0.06 if t < 12 else 0.0]
        return np.append(np.clip(10 * above, -1, 1), 1.0)
    move = np.zeros(3) if t < 24 else 10 * (obs["desired_goal"] - cube)
    return np.append(np.clip(move, -1, 1), -1.0)


def test_a_cube_is_grasped_and_carried_the_same_way(capsys: pytest.CaptureFixture[str]) -> None:
    hands, cubes = [], []
    ours = registration.make_env("PandaPickAndPlace")
    for seed in range(SEEDS):
        with repaired("PickAndPlace") as theirs:
            expected, _ = theirs.reset(seed=seed)
            actual, _ = ours.reset(seed=seed)
            np.testing.assert_allclose(actual["desired_goal"], expected["desired_goal"], atol=1e-6)
            np.testing.assert_allclose(actual["observation"], expected["observation"], atol=1e-4)
            for t in range(50):
                action = grasp(expected, t)
                expected, *_ = theirs.step(action)
                actual, *_ = ours.step(action)
                hands.append(np.linalg.norm((actual["observation"] - expected["observation"])[:3]))
        cubes.append(np.linalg.norm((actual["observation"] - expected["observation"])[7:10]))
    hand, cube, worst = (1000 * x for x in (np.median(hands), np.median(cubes), max(cubes)))
    with capsys.disabled():
        print(f"\n  hand {hand:.2f} mm, cube in the end {cube:.2f} mm in the median, {worst:.1f} mm at most", end="")
    assert hand < 2.0
    assert cube < 3.0
