"""The viewer's page in a real browser, without a display or a GPU."""

import re
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import viser
from browsed import SIZE, number_box, on_page, pixels, row_of_slider, show, until
from PIL import Image

import manyhands as mh
from manyhands.panda_gym import registration
from manyhands.training.evaluation import PolicyFile
from manyhands.viewer import Viewer

READY = [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.02, 0.02]


@pytest.fixture(scope="module")
def arm() -> Iterator[Viewer]:
    """A Panda that its motors hold."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    with Viewer(world, port=18510, title="Panda", announce=False) as viewer:
        joints = viewer.source.joints
        assert joints is not None
        ready = dict(zip([knob.name for knob in joints.knobs], READY, strict=True))
        viewer.player.do(lambda: joints.move(ready, place=True), wait=5.0)
        yield viewer


@pytest.fixture(scope="module")
def reach() -> Iterator[Viewer]:
    env = registration.make_env(**registration.VARIANTS["PandaReach"])
    env.reset(seed=0)
    env.spec = gymnasium.spec("PandaReach-v3")
    with Viewer(env, port=18520, title="PandaReach-v3", announce=False) as viewer:
        yield viewer


def opened(page: Any, viewer: Viewer) -> None:
    """Shows a viewer on the page."""
    show(page, viewer)
    page.get_by_role("button", name=re.compile("^(Play|Pause)$")).wait_for()


def choose(page: Any, label: str, name: str) -> None:
    """Takes one of a list. A page that draws slowly is never at rest, as a click with the mouse wants it."""
    page.get_by_label(label).dispatch_event("click")
    page.get_by_role("option", name=name, exact=True).dispatch_event("click")
    wait_for_choice(page, label, name)


def wait_for_choice(page: Any, label: str, name: str) -> None:
    until(lambda: page.get_by_label(label).input_value() == name)


def test_the_page_shows_the_arm(arm: Viewer, page: Any, tmp_path: Path) -> None:
    opened(page, arm)
    shown = pixels(page, tmp_path / "arm.png")

    def differs() -> bool:
        """From a page without bodies, at thousands of pixels, some of them dark and some orange as the arm's rings."""
        nonlocal shown
        shown = pixels(page, tmp_path / "arm.png")
        dark = (shown.max(-1) < 70).sum()
        orange = ((shown[..., 0] > 150) & (shown[..., 2] < 90)).sum()
        return dark > 100 and orange > 5

    until(differs)
    for body in arm.stage._bodies:
        body.visible = False
    until(lambda: (pixels(page, tmp_path / "empty.png").max(-1) < 70).sum() < 20)
    empty = pixels(page, tmp_path / "empty.png")
    for body in arm.stage._bodies:
        body.visible = True
    assert (np.abs(shown.astype(int) - empty).max(-1) > 8).sum() > 5000


def test_moving_a_slider_moves_the_robot(arm: Viewer, page: Any) -> None:
    opened(page, arm)
    world = arm.source.world
    assert world is not None
    before, _ = world.body_pose("panda_grasptarget")
    page.get_by_role("tab", name="Robot").click()
    box = number_box(page, "joint1 [°]")
    box.fill("45")
    box.press("Enter")
    until(lambda: abs(world.q[0] - np.pi / 4) < 1e-6)
    after, _ = world.body_pose("panda_grasptarget")
    assert np.allclose(after[:2], np.hypot(*before[:2]) * np.sqrt([0.5, 0.5]), atol=1e-6)
    assert world.time == 0  # it stands still: the joint was put there

    page.get_by_role("button", name="Play", exact=True).click()
    until(lambda: world.time > 0)
    box = number_box(page, "joint1 [°]")
    box.fill("12")
    box.press("Enter")
    until(lambda: abs(world.q[0] - np.pi / 15) < 5e-3)  # driven there, by its motor
    page.get_by_role("button", name="Pause", exact=True).click()
    until(lambda: not arm.player.playing)


def test_a_goal_is_shown_and_gone_to(arm: Viewer, page: Any) -> None:
    opened(page, arm)
    assert arm.panel.robot is not None and arm.panel.robot.plan is not None
    plan = arm.panel.robot.plan
    page.get_by_role("tab", name="Robot").click()
    page.get_by_label("Drag a goal").click()
    until(lambda: plan.goal is not None)
    position, quaternion = plan.goal or (np.zeros(3), np.zeros(4))
    wanted = position + np.array([0, 0.1, 0.05])
    plan.show_goal(True, (wanted, quaternion))
    page.get_by_role("button", name="Plan and go").click()
    page.get_by_text("found in").wait_for()
    world = arm.source.world
    assert world is not None
    until(lambda: np.linalg.norm(world.body_pose("panda_grasptarget")[0] - wanted) < 5e-3)
    plan.show_goal(False)
    arm.pause()


def test_pause_step_and_reset(arm: Viewer, page: Any) -> None:
    opened(page, arm)
    arm.pause()
    time.sleep(0.2)
    stopped = arm.source.time
    page.get_by_role("button", name="Step", exact=True).click()
    until(lambda: arm.source.time > stopped)
    time.sleep(0.2)
    assert arm.source.time == pytest.approx(stopped + arm.source.dt)
    page.keyboard.press("n")
    until(lambda: arm.source.time > stopped + 1.5 * arm.source.dt)
    page.keyboard.press("p")
    until(lambda: arm.player.playing)
    page.keyboard.press("p")
    until(lambda: not arm.player.playing)
    page.get_by_role("button", name="Reset", exact=True).click()
    until(lambda: arm.source.time == 0)


def test_rewinding_by_the_slider(arm: Viewer, page: Any) -> None:
    opened(page, arm)
    arm.reset()
    arm.play()
    until(lambda: arm.source.time > 2.0)
    arm.pause()
    assert arm.player.do(lambda: None, wait=5.0)
    end = arm.player.history.span[1]
    until(lambda: arm.panel._rewind.handle.min <= -1.5)
    # What is typed while the page still learns how far back it may go would be overwritten.
    slider = row_of_slider(page, "Rewind [s]").get_by_role("slider")
    until(lambda: float(slider.get_attribute("aria-valuemin")) == arm.panel._rewind.handle.min)
    box = number_box(page, "Rewind [s]")
    box.fill("-1")
    box.press("Enter")
    until(lambda: arm.player.moment < end - 0.8)
    assert arm.player.moment == pytest.approx(end - 1.0, abs=0.1)


def test_a_body_is_pulled_with_the_mouse(page: Any) -> None:
    world = mh.World()
    world.add_plane("floor")
    world.add_box("box", [0.3, 0.3, 0.3], mass=0.5, position=[0, 0, 0.3])
    with Viewer(world, port=18515, announce=False) as viewer:
        opened(page, viewer)
        viewer.pull = 200.0
        x, y = on_page(viewer, page, [0, 0, 0.3])
        page.keyboard.down("Control")
        try:
            page.mouse.move(x, y)
            page.mouse.down()
            for k in range(1, 9):
                page.mouse.move(x, y - 15 * k)
                time.sleep(0.2)
            until(lambda: viewer.source.pushes)
            (push,) = viewer.source.pushes.values()
            assert push.link == "box"
            assert push.force[2] > 7.0  # upwards, where it is dragged to, and more than its weight
            viewer.play()
            until(lambda: world.body_pose("box")[0][2] > 0.31)
            page.mouse.up()
        finally:
            page.keyboard.up("Control")
        until(lambda: not viewer.source.pushes)
        page.goto("about:blank")


def test_a_reach_by_hand_succeeds(reach: Viewer, page: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys are pressed as a person would: whichever brings the hand nearer to the goal."""
    opened(page, reach)
    source: Any = reach.source
    keys = {(0, True): "i", (0, False): "k", (1, True): "j", (1, False): "l", (2, True): "u", (2, False): "o"}
    deadline = time.perf_counter() + 60
    while not source.outcome.successes:
        assert time.perf_counter() < deadline, "the goal was not reached"
        seen = source.outcome.observation
        way = seen["desired_goal"] - seen["achieved_goal"]
        axis = int(np.abs(way).argmax())
        page.keyboard.press(keys[axis, bool(way[axis] > 0)])
        # A slow browser must not be left with keys that it passes on once the goal is reached.
        page.evaluate("() => new Promise(requestAnimationFrame)")
        time.sleep(0.1)
    page.get_by_text("Episodes: 1, of which 1 reached the goal").wait_for()
    reach.pause()


def test_buttons_drive_too(reach: Viewer, page: Any) -> None:
    opened(page, reach)
    source: Any = reach.source
    reach.reset()
    until(lambda: source.outcome.length == 0)
    before = source.outcome.observation["achieved_goal"][2]
    button = page.get_by_role("button", name=re.compile("^Up"))
    button.hover()
    page.mouse.down()
    until(lambda: source.outcome.observation["achieved_goal"][2] > before + 0.02)
    page.mouse.up()
    reach.pause()


def test_a_learned_policy_is_chosen_and_acts(reach: Viewer, page: Any, reach_policy: Path) -> None:
    opened(page, reach)
    reach.pause()
    reach.actor("what was learned", PolicyFile(reach_policy))
    reach.speed = 5
    source: Any = reach.source
    wait_for_choice(page, "Who acts", "what was learned")
    for name, expected in (("nobody", "Not reached."), ("what was learned", "Reached!")):
        assert reach.player.do(lambda: None, wait=5.0)
        before = source.policy
        choose(page, "Who acts", name)
        until(lambda before=before: source.policy is not before and not source.outcome.episodes)
        assert source.limit == 50
        reach.play()
        page.get_by_text(expected).wait_for()
        until(lambda: source.outcome.episodes > 1)
        reach.pause()
        assert reach.player.do(lambda: None, wait=5.0)
        page.get_by_text(f"Episodes: {source.outcome.episodes}, ").wait_for()
        assert source.outcome.successes == (source.outcome.episodes if name == "what was learned" else 0)
    reach.speed = 1


def test_worlds_of_many_are_chosen_and_stand_side_by_side(page: Any, tmp_path: Path) -> None:
    """While a loop steps them."""
    envs: Any = gymnasium.make_vec("PandaReach-v3", num_envs=4, num_threads=1)
    envs.reset(seed=0)
    ended = threading.Event()
    with Viewer(envs, port=18525, announce=False) as viewer:

        def loop() -> None:
            while not ended.is_set():
                envs.step(np.zeros((4, 3)))
                viewer.sync()

        thread = threading.Thread(target=loop)
        thread.start()
        try:
            opened(page, viewer)
            source: Any = viewer.source
            page.get_by_role("button", name="Next", exact=True).dispatch_event("click")
            until(lambda: source.chosen == 1)
            page.get_by_text("World 1: step").wait_for()
            choose(page, "Side by side", "4")
            until(lambda: viewer.stage.neighbours._batches)

            def others(seen: bool) -> Any:
                for batch in viewer.stage.neighbours._batches.values():
                    batch.visible = seen
                time.sleep(1.0)
                return pixels(page, tmp_path / "worlds.png").astype(int)

            until(lambda: (np.abs(others(True) - others(False)).max(-1) > 20).sum() > 3000)
        finally:
            ended.set()
            thread.join()
        page.goto("about:blank")


def test_the_recording_opens_alone(arm: Viewer, page: Any, browser: Any, tmp_path: Path) -> None:
    opened(page, arm)
    joints = arm.source.joints
    assert joints is not None
    start = arm.source.time
    arm.player.do(lambda: joints.move({"panda_joint1": -1.0}))
    arm.play()
    until(lambda: arm.source.time > start + 1.0)
    arm.pause()
    page.get_by_role("tab", name="Share").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as a page").click()
    path = tmp_path / "recording.html"
    download.value.save_as(path)
    page.goto("about:blank")
    alone = browser.new_context(offline=True, viewport=SIZE).new_page()
    alone.set_default_timeout(60000)
    try:
        asked: list[str] = []
        alone.on("request", lambda request: asked.append(request.url))
        alone.goto(path.as_uri())
        shown = tmp_path / "alone.png"
        until(lambda: (pixels(alone, shown, 860).max(-1) < 70).sum() > 100)
        assert not [address for address in asked if address.startswith(("http", "ws"))]
        # It moves: the pictures of two moments differ.
        first = pixels(alone, shown, 860).astype(int)
        until(lambda: (np.abs(pixels(alone, shown, 860) - first).max(-1) > 30).sum() > 50)
    finally:  # a page that stays open would slow those after it
        alone.close()


def test_a_picture_is_saved(arm: Viewer, page: Any, tmp_path: Path) -> None:
    opened(page, arm)
    page.get_by_role("tab", name="View").click()
    with page.expect_download() as download:
        page.get_by_role("button", name="Save a picture").click()
    download.value.save_as(tmp_path / "picture.png")
    assert (np.asarray(Image.open(tmp_path / "picture.png").convert("RGB")).max(-1) < 70).sum() > 100
    assert arm.picture(320, 200).shape == (200, 320, 3)


def test_a_foreign_page_cannot_connect(arm: Viewer, page: Any) -> None:
    address = f"ws://127.0.0.1:{arm.server.get_port()}"
    connect = """([address, version]) => new Promise(done => {
        const socket = new WebSocket(address, 'viser-v' + version)
        socket.onopen = () => done('open'); socket.onerror = () => done('refused') })"""
    page.goto("data:text/html,<p>elsewhere</p>")
    assert page.evaluate(connect, [address, viser.__version__]) == "refused"
    page.goto(address.replace("ws", "http"))
    assert page.evaluate(connect, [address, viser.__version__]) == "open"


def test_with_a_token_the_page_opens_and_without_it_does_not(page: Any) -> None:
    world = mh.World()
    world.add_box("box", [0.1, 0.1, 0.1], mass=1.0, position=[0, 0, 0.1])
    with Viewer(world, host="0.0.0.0", port=18530, announce=False) as viewer:
        assert page.goto(viewer.url.partition("?")[0]).status == 403
        page.goto("about:blank")
        opened(page, viewer)
        page.get_by_role("button", name="Step", exact=True).click()
        until(lambda: viewer.source.time > 0)
        page.goto("about:blank")
