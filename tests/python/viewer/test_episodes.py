"""Environments on a page: who acts, how episodes end, and what `manyhands view` is asked for."""

import webbrowser
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from viewed import until

from manyhands import cli, robots
from manyhands.cli import view
from manyhands.envs import Expert
from manyhands.envs.single import ArmEnv
from manyhands.panda_gym import registration
from manyhands.viewer import Viewer
from manyhands.viewer.environments import DropInSource, EnvSource, NativeSource, source_of_environment


def source_of(env: Any, seed: int = 0) -> EnvSource:
    """Of an environment whose episodes are as long as gymnasium has them."""
    env.spec = gymnasium.spec("PandaReach-v3")
    source = source_of_environment(env)
    assert source is not None
    source.reset(seed)
    return source


@pytest.fixture(params=[ArmEnv, registration.make_env])
def reach(request: pytest.FixtureRequest) -> EnvSource:
    return source_of(request.param(task="PandaReach"))


# ---- episodes ----------------------------------------------------------------------------------------------------


def test_an_episode_ends_with_success_and_another_begins(reach: EnvSource) -> None:
    expert = Expert("PandaReach")
    reach.policy = lambda outcome: expert(outcome.observation)
    goals = []
    for episode in range(1, 4):
        goals.append(reach.outcome.observation["desired_goal"].copy())
        while not reach.outcome.ended:
            assert reach.rest == 0
            reach.step()
        last = reach.outcome
        assert last.success and (last.episodes, last.successes) == (episode, episode)
        assert np.linalg.norm(last.observation["achieved_goal"] - goals[-1]) < 0.05
        assert reach.rest > 0  # so that it is seen
        reach.step()
        begun = reach.outcome
        assert (begun.length, begun.total, begun.ended) == (0, 0.0, False)
        assert not np.array_equal(begun.observation["desired_goal"], goals[-1])
    assert reach.outcome.successes == 3


def test_an_episode_that_lasts_too_long_ends_without_success(reach: EnvSource) -> None:
    reach.policy = lambda _: np.array([-1.0, 0.0, 1.0])  # away from all goals
    for _ in range(50):
        assert not reach.outcome.ended
        reach.step()
    assert reach.outcome.ended and not reach.outcome.success
    assert (reach.outcome.episodes, reach.outcome.successes) == (1, 0)
    reach.step()
    assert reach.outcome.length == 0
    reach.limit = None  # as for those who drive by hand
    for _ in range(60):
        reach.step()
    assert reach.outcome.length == 60 and not reach.outcome.ended


def test_episodes_need_not_end(reach: EnvSource) -> None:
    expert = Expert("PandaReach")
    reach.policy, reach.ends = lambda outcome: expert(outcome.observation), False
    for _ in range(60):
        reach.step()
    assert reach.outcome.length == 60 and reach.rest == 0
    assert (reach.outcome.episodes, reach.outcome.successes) == (1, 1)  # counted once


def test_going_back_uncounts_what_ended_since(reach: EnvSource) -> None:
    expert = Expert("PandaReach")
    reach.policy = lambda outcome: expert(outcome.observation)
    start = reach.save()
    while reach.outcome.episodes < 2:
        reach.step()
    reach.restore(start)
    assert reach.outcome.episodes == 0
    reach.step()
    reach.count_anew()
    assert reach.outcome.length == 1


def test_the_gripper_is_the_number_beyond_the_arms() -> None:
    for robot, arm in (("panda", 7), ("arm6", 6)):
        for task, grips in (("PandaReach", False), ("PandaPickAndPlace", True)):
            source = source_of(ArmEnv(task, robot=robot, control_type="joint_velocity"))
            assert source.action_size == arm + grips
            assert source.has_grip == grips
            assert source_of(ArmEnv(task, robot=robot, control_type="ee_pose")).has_grip == grips


# ---- who acts ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def page() -> Iterator[Viewer]:
    env = registration.make_env(task="PandaReach")
    env.reset(seed=0)
    env.spec = gymnasium.spec("PandaReach-v3")
    with Viewer(env, port=18450, announce=False) as viewer:
        yield viewer


def told(viewer: Viewer) -> EnvSource:
    """What is shown, after all that was asked for is done."""
    assert viewer.player.do(lambda: None, wait=5.0)
    source = viewer.source
    assert isinstance(source, EnvSource)
    return source


def action_of(source: EnvSource) -> Any:
    assert source.policy is not None
    return source.policy(source.outcome)


def test_the_page_offers_who_may_act(page: Viewer) -> None:
    panel = page.panel.teleop
    assert panel is not None
    assert panel._actor.options == (
        "keys and buttons", "sliders and gizmo", "nobody", "random actions", "scripted expert"
    )  # fmt: skip
    assert panel._actor.value == "scripted expert"  # whoever opens the page sees something happen
    panel._actor.value = "keys and buttons"
    source = told(page)
    assert source.limit is None  # hands take their time
    panel._actor.value = "nobody"
    assert not np.any(action_of(told(page)))
    panel._actor.value = "random actions"
    assert not np.array_equal(action_of(told(page)), action_of(source))
    assert source.limit == 50
    panel._actor.value = "scripted expert"
    assert np.array_equal(action_of(told(page)), Expert("PandaReach")(source.outcome.observation))
    panel._actor.value = "sliders and gizmo"
    assert told(page).policy is None


def test_a_policy_acts_once_it_is_given(page: Viewer) -> None:
    seen = []

    def act(observation: Any) -> Any:
        seen.append(observation["desired_goal"])
        return np.ones(3)

    page.actor("mine", act)
    panel, source = page.panel.teleop, told(page)
    assert panel is not None and panel._actor.value == "mine"
    page.step(3)
    assert page.player.do(lambda: None, wait=5.0)
    assert len(seen) >= 1
    assert np.array_equal(seen[0], source.outcome.observation["desired_goal"])
    page.actor("mine", lambda _: np.zeros(3))  # in its place
    assert panel._actor.options.count("mine") == 1
    assert not np.any(action_of(told(page)))


def test_an_expert_begins_anew_with_each_episode(page: Viewer) -> None:
    panel = page.panel.teleop
    assert panel is not None
    panel._actor.value = "scripted expert"
    before = told(page).policy
    page.reset()
    assert told(page).policy is not before


def test_what_hands_began_does_not_count_as_the_experts(page: Viewer) -> None:
    """Their episode was longer than those of experts may be, and ended at once, as a failure of the expert's."""
    panel = page.panel.teleop
    assert panel is not None
    panel._actor.value = "keys and buttons"
    source = told(page)
    while source.outcome.length <= 50 or source.outcome.success:
        source.step()
    panel._actor.value = "scripted expert"
    source = told(page)
    while source.outcome.episodes < 3:
        source.step()
    assert source.outcome.successes == source.outcome.episodes


def test_a_key_takes_over_from_whoever_acts(page: Viewer) -> None:
    panel = page.panel.teleop
    assert panel is not None
    panel._actor.value = "scripted expert"
    told(page)
    try:
        panel.press(2, 1.0)
        assert panel._actor.value == "keys and buttons" and page.player.playing
    finally:
        page.pause()


def test_experts_are_offered_where_they_can_act() -> None:
    for options, offered in (({}, True), ({"robot": "arm6"}, True), ({"control_type": "ee_pose"}, False)):
        env = ArmEnv("PandaReach", **options)
        env.reset(seed=0)
        with Viewer(env, port=18455, title="PandaReach-v3", announce=False) as viewer:
            panel = viewer.panel.teleop
            assert panel is not None
            assert ("scripted expert" in panel._actor.options) == offered


def test_a_loop_of_the_programs_is_said_to_act(page: Viewer) -> None:
    panel, source = page.panel.teleop, told(page)
    assert panel is not None
    page.speed = float("inf")
    source.env.step(np.zeros(3))
    page.sync()
    panel.refresh(page.player._frame)  # pyright: ignore[reportArgumentType]
    assert panel._status.content == "A loop of the program's acts."
    page.speed = 1.0


# ---- the command -------------------------------------------------------------------------------------------------


def shown(*arguments: str) -> Viewer:
    return view.shown(cli._parser().parse_args(["view", *arguments, "--port", "18460"]))


def test_an_environment_opens_with_its_expert_moving() -> None:
    for arguments, plays in ((["PandaPickAndPlace"], True), (["PandaPush", "--no-play"], False), (["panda"], False)):
        with shown(*arguments) as viewer:
            assert viewer.player.playing == plays
            if viewer.panel.teleop is not None:
                assert viewer.panel.teleop._actor.value == "scripted expert"


def test_the_browser_opens_where_somebody_would_see_it(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(webbrowser, "open", asked.append)
    for screen, arguments, opens in (("", [], 0), (":0", [], 1), (":0", ["--no-open"], 0), ("", ["--open"], 1)):
        asked.clear()
        monkeypatch.setenv("DISPLAY", screen)
        with shown("table", *arguments) as viewer:
            until(lambda opens=opens: len(asked) == opens)
            assert all(address == viewer.url for address in asked)


def test_a_learned_policy_reaches_on_the_page(reach_policy: Path) -> None:
    with shown("PandaReach", "--policy", str(reach_policy), "--play") as viewer:
        source = told(viewer)
        assert isinstance(source, DropInSource)  # may be pushed while it acts
        viewer.pause()
        told(viewer)
        while source.outcome.episodes < 20:
            source.step()
        assert source.outcome.successes == source.outcome.episodes


def test_another_robot_and_control_are_shown() -> None:
    with shown("PandaPush", "--robot", "arm6", "--control", "ee_pose", "--option", "object_shape=cylinder") as viewer:
        source = told(viewer)
        assert isinstance(source, NativeSource)
        assert source.title == "PandaPush-v3 (robot arm6, control_type ee_pose, object_shape cylinder)"
        assert source.action_size == 6 and source.limit is None and source.max_steps == 50
        assert any(link.name.startswith("arm6") for link in source.model.links)
        shapes = {geom.shape for geom in source.model.geoms if geom.name.startswith("object")}
        assert shapes == {"cylinder"}
    with shown("PandaReach", "--control", "joints") as viewer:
        assert isinstance(viewer.source, DropInSource)
        assert viewer.source.action_size == 7


def test_an_arm_that_ships_stands_at_home_with_its_gripper() -> None:
    with shown("six_axis+two_finger") as viewer:
        source = viewer.source
        viewer.player.do(lambda: [source.step() for _ in range(500)], wait=10.0)
        for joint, place in robots.describe("six_axis").home.items():
            assert source.q[source.model.joint(joint).iq] == pytest.approx(place, abs=1e-4)
        assert source.q[source.model.joint("gripper/finger_joint").iq] == pytest.approx(0, abs=1e-4)


def test_nonsense_is_refused(tmp_path: Path, reach_policy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, text in (
        (["PandaReach", "--robot", "ur5"], "expected 'panda', 'arm6'"),
        (["PandaReach", "--control", "mind"], "expected one of ['ee', 'joints'"),
        (["PandaReach", "--option", "speed=3"], "there is no option 'speed'"),
        (["PandaReach", "--option", "object_shape"], "expected NAME=VALUE"),
        (["PandaReach", "--option", "n_substeps=many"], "n_substeps is 'many', expected a whole number"),
        (["PandaReach", "--option", "render_mode=human"], "render_mode is no option"),
        (["PandaReach", "--option", 'obstacles=[{"form": "box"}]'], '"shape": "sphere"'),
        (["PandaReach", "--policy", str(tmp_path)], "there is no file"),
        (["PandaPush", "--policy", str(reach_policy)], "the policy does not fit PandaPush-v3"),
        (["PandaReach", "--control", "joints", "--policy", str(reach_policy)], "does not fit"),
        (["panda", "--robot", "arm6"], "panda is none"),
        (["panda", "--policy", str(reach_policy)], "--policy is of environments"),
    ):
        assert cli.main(["view", *arguments]) == 2, arguments
        assert text in capsys.readouterr().err
