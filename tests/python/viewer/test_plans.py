"""Plans on the page: a goal that is dragged, the way to it, and the arm that follows."""

from collections.abc import Iterator

import numpy as np
import pytest
from viewed import READY, panda, until

import manyhands as mh
from manyhands import robots
from manyhands.viewer import Viewer
from manyhands.viewer.joints import JointDrive
from manyhands.viewer.plan_panel import PlanPanel
from manyhands.viewer.robot_panel import RobotPanel

HAND = "panda_grasptarget"
DOWN = np.array([1.0, 0.0, 0.0, 0.0])
LEFT, RIGHT = np.array([0.5, 0.3, 0.25]), np.array([0.5, -0.3, 0.25])


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    """A Panda beside a post, as fast as it goes."""
    world = panda()
    world.add_cylinder("post", 0.04, 0.25, position=(0.5, 0, 0.27), fixed=True)
    with Viewer(world, port=18470, announce=False) as shown:
        shown.speed = np.inf
        joints = shown.source.joints
        assert joints is not None
        ready = dict(zip([knob.name for knob in joints.knobs], [0.9, *READY[1:]], strict=True))
        shown.player.do(lambda: joints.move(ready, place=True), wait=30.0)
        yield shown


def panels(viewer: Viewer) -> tuple[RobotPanel, PlanPanel]:
    robot = viewer.panel.robot
    assert robot is not None and robot.plan is not None
    return robot, robot.plan


def hand(viewer: Viewer) -> np.ndarray:
    assert viewer.source.world is not None
    return np.asarray(viewer.source.world.body_pose(HAND)[0])


def go(viewer: Viewer, goal: np.ndarray) -> None:
    _, plan = panels(viewer)
    plan.show_goal(True, (goal, DOWN))
    plan.plan_and_go()
    assert "found in" in plan.status, plan.status
    until(lambda: not plan.is_following, seconds=60)


def test_the_arm_goes_to_a_goal_that_is_dragged_and_around_what_stands_between(viewer: Viewer) -> None:
    _, plan = panels(viewer)
    assert plan.goal is None
    for goal in (LEFT, RIGHT):
        go(viewer, goal)
        until(lambda goal=goal: np.linalg.norm(hand(viewer) - goal) < 5e-3, seconds=60)
    position, quaternion = plan.goal or (np.zeros(3), np.zeros(4))
    np.testing.assert_allclose(position, RIGHT)
    np.testing.assert_allclose(quaternion, DOWN)
    plan.show_goal(False)
    assert plan.goal is None


def test_it_says_why_there_is_no_plan(viewer: Viewer) -> None:
    _, plan = panels(viewer)
    plan.plan_and_go()
    assert plan.status == "Drag a goal first"
    for goal, why in (((3.0, 0, 0), "out of reach"), ((0.5, 0, 0.3), "'post' overlap")):
        plan.show_goal(True, (np.array(goal), DOWN))
        plan.plan_and_go()
        assert "No plan" in plan.status and why in plan.status
        assert not plan.is_following


def test_it_says_what_to_do_where_the_arm_stands_in_itself() -> None:
    """As a Panda's file has it: all joints at 0."""
    with Viewer(panda(), port=18476, announce=False) as viewer:
        _, plan = panels(viewer)
        plan.show_goal(True, (LEFT, DOWN))
        plan.plan_and_go()
        assert "the start collides" in plan.status and "move its joints with the sliders first" in plan.status


def test_whatever_goes_wrong_is_said(viewer: Viewer, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise RuntimeError("lightning")

    _, plan = panels(viewer)
    plan.show_goal(True, (LEFT, DOWN))
    for where in ("plan", "__init__"):
        monkeypatch.setattr(f"manyhands.planning.Planner.{where}", fail)
        plan.plan_and_go()
        assert plan.status == "No plan: lightning" and not plan.is_following


def test_hands_resets_and_other_hands_end_a_plan(viewer: Viewer) -> None:
    robot, plan = panels(viewer)
    viewer.speed = 0.1
    plan.show_goal(True, (LEFT, DOWN))
    for end in (robot.take_over, robot.rebuild):
        panels(viewer)[1].show_goal(True, (LEFT, DOWN))
        panels(viewer)[1].plan_and_go()
        until(lambda: panels(viewer)[1].is_following, seconds=60)
        end()
        assert not panels(viewer)[1].is_following


def test_joints_that_mimic_have_no_sliders_and_all_move_together() -> None:
    world = mh.World(robots.load("two_finger"))
    drive = JointDrive(world)
    followers = {knob.name: knob.follows for knob in drive.knobs if knob.follows}
    assert followers == dict.fromkeys(("left_tip_joint", "right_crank_joint", "right_tip_joint"), "finger_joint")
    drive.move({"finger_joint": 0.3}, place=True)
    want = {"finger_joint": 0.3, "left_tip_joint": -0.3, "right_crank_joint": 0.3, "right_tip_joint": -0.3}
    assert {knob.name: pytest.approx(drive.value(knob)) for knob in drive.knobs} == want
    drive.move({"right_tip_joint": -0.1}, place=True)  # moves the one that it mimics, and with that all others
    assert {knob.name: drive.value(knob) for knob in drive.knobs} == pytest.approx({k: x / 3 for k, x in want.items()})
    with Viewer(world, port=18475, announce=False) as viewer:
        assert viewer.panel.robot is not None
        assert [*viewer.panel.robot.sliders] == ["finger_joint"]
