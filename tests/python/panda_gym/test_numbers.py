"""The drop-in's arm and objects move as panda-gym's: numbers measured on panda-gym 3.0.7."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import manyhands as mh  # noqa: F401  registers its own environments first
from manyhands.panda_gym import registration

TASKS = ("Reach", "Slide", "Push", "PickAndPlace", "Stack", "Flip")


def make(task: str, **kwargs: Any) -> Any:
    return registration.make_env(f"Panda{task}", **kwargs)


def run(env: Any, steps: int) -> list[Any]:
    size = env.action_space.shape[0]
    return [env.step(np.sin(1.3 * t + 0.7 * np.arange(size) + 0.4))[0] for t in range(steps)]


# Displacements of the hand measured on panda-gym 3.0.7: (x, y, z) after each step that holds the action.
HELD = {
    (1, 0, 0): [(0.0268, 0, -0.0025), (0.0530, 0, -0.0081), (0.0767, 0, -0.0131)],
    (0, 1, 0): [(0.0007, 0.0244, 0), (-0.0010, 0.0749, -0.0002), (-0.0027, 0.1173, -0.0003)],
    (0, 0, 1): [(-0.0071, 0, 0.0105), (-0.0069, 0, 0.0437), (-0.0081, 0, 0.0847)],
    (0, 0, -1): [(0.0056, 0, -0.0252), (-0.0009, 0, -0.0838), (-0.0066, 0, -0.1415)],
    (-1, 0, 0): [(-0.0340, 0, -0.0057), (-0.0663, 0, -0.0052), (-0.1018, 0, -0.0072)],
}


@pytest.mark.parametrize("action", HELD)
def test_responses_to_a_held_action(action: tuple[int, int, int]) -> None:
    env = make("Reach")
    start = env.reset(seed=0)[0]["achieved_goal"]
    moved = [env.step(np.array(action, float))[0]["achieved_goal"] - start for _ in HELD[action]]
    off = np.linalg.norm(np.subtract(moved, HELD[action]), axis=1)
    # Theirs is read 2 ms late at up to 1.3 m/s, and each action starts from that reading.
    assert (off < 0.003 + 0.0015 * np.arange(len(off))).all(), off


def test_the_hand_stops_at_the_table() -> None:
    env = make("Reach")
    env.reset(seed=0)
    heights = [env.step(np.array([0.0, 0.0, -1.0]))[0]["achieved_goal"][2] for _ in range(12)]
    # At 0.004 in panda-gym, whose finger tips yield; ours reach 7.2 mm beyond the point between them.
    assert heights[-1] == pytest.approx(0.0072, abs=5e-4)


def test_no_action_keeps_still() -> None:
    env = make("Reach")
    start = env.reset(seed=0)[0]["achieved_goal"]
    y = [env.step(np.zeros(3))[0]["achieved_goal"][1] - start[1] for _ in range(20)]
    assert y[0] == pytest.approx(0.0007, abs=2e-4)
    np.testing.assert_allclose(y[10:], y[-1], atol=1e-4)


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize(
    ("control_type", "third", "sixth", "velocity", "tolerance"),
    [
        ("ee", (0.08222, 0.04101, 0.18278), (0.02851, 0.02880, 0.12189), (0.3337, 0.8557, 0.5475), 6e-3),
        ("joints", (-0.00576, 0.03472, 0.12583), (0.02091, 0.03361, 0.13307), (-0.2538, 0.8936, -0.5983), 2e-3),
    ],
)
def test_the_reference_trajectory(
    task: str,
    control_type: str,
    third: tuple[float, ...],
    sixth: tuple[float, ...],
    velocity: tuple[float, ...],
    tolerance: float,
) -> None:
    env = make(task, control_type=control_type)
    env.reset(seed=7)
    hand = np.array([obs["observation"][:6] for obs in run(env, 6)], float)
    read_late = hand[:, :3] - 0.002 * hand[:, 3:]  # as the reference was
    np.testing.assert_allclose(read_late[2], third, atol=tolerance)
    np.testing.assert_allclose(read_late[5], sixth, atol=tolerance)
    np.testing.assert_allclose(hand[5, 3:], velocity, atol=0.05)
    if not env.block_gripper and control_type == "ee":
        # Its two fingers are two motors; here they share the force of both.
        assert env.robot.get_fingers_width() == pytest.approx(0.07914, abs=2e-3)


SETTLED = {
    "Push": (-0.08244, -0.05995, 0.01999),
    "Slide": (-0.08253, -0.05974, 0.01498),
    "PickAndPlace": (-0.05995, 0.11207, 0.01999),
    "Stack": (-0.08244, -0.05995, 0.01999),
}


@pytest.mark.parametrize("task", SETTLED)
def test_objects_settle_where_they_settle_in_panda_gym(task: str) -> None:
    env = make(task)
    env.reset(seed=7)
    run(env, 6)
    position = env.sim.get_base_position("object1" if task == "Stack" else "object")
    np.testing.assert_allclose(position, SETTLED[task], atol=1e-3)


def test_the_gripper_opens_and_closes_as_fast() -> None:
    env = make("PickAndPlace")
    env.reset(seed=0)
    widths = []
    for opening in (1, 1, 1, -1, -1, -1):
        env.step(np.array([0, 0, 0, opening]))
        widths.append(env.robot.get_fingers_width())
    np.testing.assert_allclose(widths, [0.0703, 0.0788, 0.0799, 0.0097, 0.0012, 0.0001], atol=1e-3)


def test_joints_control() -> None:
    env = make("Reach", control_type="joints")
    env.reset(seed=1)
    expected = [
        (0.0059, 0.4537, 0.0420, -1.8075, 0.0422, 2.3039, 0.8339),
        (0.0584, 0.4986, 0.0849, -1.7644, 0.0852, 2.3478, 0.8779),
        (0.1058, 0.5436, 0.1279, -1.7213, 0.1281, 2.3918, 0.9218),
    ]
    for angles in expected:
        env.step(np.ones(7))
        np.testing.assert_allclose([env.robot.get_joint_angle(i) for i in range(7)], angles, atol=2e-3)


def steps_to_success(env: Any, seed: int, policy: Callable[[Any], Any]) -> int:
    """At most 50."""
    obs, _ = env.reset(seed=seed)
    for t in range(1, 51):
        obs, _, terminated, _, _ = env.step(policy(obs))
        if terminated:
            return t
    pytest.fail(f"seed {seed} was not solved")


def test_the_manuals_policy_is_as_fast() -> None:
    """1 to 8 steps in panda-gym, 5.4 in the mean."""
    env = make("Reach")
    lengths = [
        steps_to_success(env, seed, lambda obs: 5 * (obs["desired_goal"] - obs["observation"][:3]))
        for seed in range(40)
    ]
    assert max(lengths) <= 8 + 2
    assert np.mean(lengths) == pytest.approx(5.4, abs=0.5)


class Grasp:
    """Hovers above the cube, goes down, closes the gripper, carries."""

    def __init__(self) -> None:
        self.phase, self.steps = "hover", 0

    def __call__(self, obs: Any) -> Any:
        hand, cube = obs["observation"][:3], obs["observation"][7:10]
        above = cube - hand
        above[2] += 0.06 if self.phase == "hover" else 0.0
        self.steps += 1
        limit = {"hover": 12, "descend": 8, "close": 4}.get(self.phase, 1000)
        phase = self.phase
        if self.steps >= limit:
            self.phase, self.steps = {"hover": "descend", "descend": "close", "close": "carry"}[phase], 0
        if phase in ("hover", "descend"):
            return np.append(np.clip(10 * above, -1, 1), 1.0)
        move = 10 * (obs["desired_goal"] - cube) if phase == "carry" else np.zeros(3)
        return np.append(np.clip(move, -1, 1), -1.0)


def test_a_cube_is_grasped_and_carried_as_fast() -> None:
    """Ten of ten in panda-gym, in 26 to 30 steps each, of which 24 before it carries."""
    env = make("PickAndPlace")
    lengths = [steps_to_success(env, seed, Grasp()) for seed in range(10)]
    assert min(lengths) >= 26 - 2
    assert max(lengths) <= 30 + 2
