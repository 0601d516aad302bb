"""The pages of clients with a window, without a browser."""

import math
import threading
import time
import urllib.error
import urllib.request
import webbrowser
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from gui_clients import PANDA, box, page_of, position, run_program, until

import manyhands.pybullet as p
from manyhands.pybullet import gui as windows


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """With a page, and no browser."""
    pytest.importorskip("viser")
    monkeypatch.setenv(windows.SWITCH, "1")
    for display in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(display, raising=False)
    client = p.connect(p.GUI)
    assert windows.page(client) is not None
    yield client
    if p.isConnected(client):
        p.disconnect(client)


def test_the_page_shows_bodies_lines_sliders_and_colours(shown: int) -> None:
    page = page_of(shown)
    cube = box(shown, at=(1, 0, 1))
    line = p.addUserDebugLine([0, 0, 0], [0, 0, 1], [1, 0, 0], parentObjectUniqueId=cube, physicsClientId=shown)
    text = p.addUserDebugText("here", [0, 0, 1], physicsClientId=shown)
    points = p.addUserDebugPoints([[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]], physicsClientId=shown)
    slider = p.addUserDebugParameter("speed", 0, 5, 2, physicsClientId=shown)
    button = p.addUserDebugParameter("go", 1, 0, 0, physicsClientId=shown)
    overlays, stage = page.viewer.overlays, page.viewer.stage
    until(lambda: {f"item {k}" for k in (line, text, points)} <= overlays._lines.keys())
    until(lambda: {slider, button} <= page._parameters.handles.keys())
    label = next(name for name in stage.index if name.startswith(f"b{cube}/"))
    np.testing.assert_allclose(stage._bodies[stage.index[label]].position, [1, 0, 1])
    np.testing.assert_allclose(overlays._lines[f"item {line}"].points, [[[1, 0, 1], [1, 0, 2]]], atol=1e-6)

    p.resetBasePositionAndOrientation(cube, [0, 2, 3], [0, 0, 0, 1], physicsClientId=shown)
    until(lambda: np.allclose(stage._bodies[stage.index[label]].position, [0, 2, 3]))
    until(lambda: np.allclose(overlays._lines[f"item {line}"].points, [[[0, 2, 3], [0, 2, 4]]]))

    page._parameters.handles[slider].value = 3.5
    until(lambda: p.readUserDebugParameter(slider, physicsClientId=shown) == 3.5)

    p.changeVisualShape(cube, -1, rgbaColor=[1, 0, 0, 0.5], physicsClientId=shown)
    until(lambda: any(mesh.opacity == 0.5 for mesh in stage._surfaces.values()))

    p.removeAllUserParameters(physicsClientId=shown)
    p.removeUserDebugItem(line, physicsClientId=shown)
    until(lambda: not page._parameters.handles and f"item {line}" not in overlays._lines)
    p.resetSimulation(physicsClientId=shown)
    until(lambda: label not in stage.index)
    assert not page.viewer.player.problem


def test_the_page_is_still_while_rendering_is_off(shown: int) -> None:
    page = page_of(shown)
    p.configureDebugVisualizer(p.COV_ENABLE_RENDERING, 0, physicsClientId=shown)
    for k in range(5):
        box(shown, at=(k, 0, 0))
    time.sleep(0.3)
    assert len(page.viewer.stage.index) == 1
    p.configureDebugVisualizer(p.COV_ENABLE_RENDERING, 1, physicsClientId=shown)
    until(lambda: len(page.viewer.stage.index) == 6)


def test_the_pages_camera_follows_the_program(shown: int) -> None:
    p.resetDebugVisualizerCamera(2, 90, 0, [0, 0, 1], physicsClientId=shown)
    camera = page_of(shown).viewer.server.initial_camera
    until(lambda: np.allclose(camera.position, [2, 0, 1]) and np.allclose(camera.look_at, [0, 0, 1]))
    box(shown, at=(5, 0, 0))  # who has chosen a camera keeps it
    until(lambda: len(page_of(shown).viewer.stage.index) == 2)
    assert np.allclose(camera.position, [2, 0, 1])


def test_the_page_shows_all_that_there_is_until_the_program_chooses(shown: int) -> None:
    camera = page_of(shown).viewer.server.initial_camera
    box(shown, at=(5, 0, 1))
    until(lambda: np.allclose(camera.look_at, [5, 0, 1]))
    box(shown, at=(7, 0, 1))
    until(lambda: np.allclose(camera.look_at, [6, 0, 1]))


@pytest.mark.parametrize("low, high", [(1, 1), (-math.inf, math.inf), (0, math.nan), (0, 1e-300), (-1e300, 1e300)])
def test_sliders_of_odd_ranges_do_not_disturb_the_page(shown: int, low: float, high: float) -> None:
    odd = p.addUserDebugParameter("odd", low, high, 0.5, physicsClientId=shown)
    plain = p.addUserDebugParameter("plain", 0, 1, 0.5, physicsClientId=shown)
    until(lambda: {odd, plain} <= page_of(shown)._parameters.handles.keys())
    assert p.readUserDebugParameter(odd, physicsClientId=shown) == 0.5


def test_a_vast_floor_is_the_pages_ground_and_is_not_dragged(shown: int) -> None:
    stage = page_of(shown).viewer.stage
    floor = p.createCollisionShape(p.GEOM_BOX, halfExtents=[50, 50, 1], physicsClientId=shown)
    p.createMultiBody(0, floor, -1, [0, 0, -1], physicsClientId=shown)
    table = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.5, 0.5, 0.1], physicsClientId=shown)
    p.createMultiBody(0, table, -1, [0, 0, 0.1], physicsClientId=shown)
    box(shown, at=(0, 0, 0.3))
    until(lambda: len(stage.index) == 4)
    until(lambda: stage.radius < 1)
    drawn = {mesh.name.split("/")[2].split()[1]: mesh for mesh in stage._surfaces.values()}
    assert drawn.keys() == {"b1", "b2"}  # and not the floor
    assert [bool(drawn[name]._impl.drag_cb) for name in ("b1", "b2")] == [False, True]


def test_a_page_that_nobody_has_open_is_drawn_seldom(shown: int) -> None:
    drawn: list[float] = []
    viewer = page_of(shown).viewer
    viewer.on_draw.append(lambda: drawn.append(0))
    time.sleep(1.5)
    assert 1 <= len(drawn) <= 8  # 4 a second
    drawn.clear()
    viewer.player._is_seen = lambda: True
    until(lambda: len(drawn) > 20)


def test_a_background_and_wire_frames(shown: int) -> None:
    page = page_of(shown)
    box(shown)
    p.configureDebugVisualizer(rgbBackground=[1, 0, 0], physicsClientId=shown)
    p.configureDebugVisualizer(p.COV_ENABLE_WIREFRAME, 1, physicsClientId=shown)
    p.configureDebugVisualizer(p.COV_ENABLE_SHADOWS, 0, physicsClientId=shown)
    until(lambda: any(mesh.wireframe for mesh in page.viewer.stage._surfaces.values()))
    assert page._background == [1, 0, 0] and not page.viewer.stage.shadows


def test_the_page_wants_its_token(shown: int) -> None:
    address, _, token = page_of(shown).viewer.url.partition("?token=")
    assert len(token) > 16
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(address)
    assert urllib.request.urlopen(f"{address}?token={token}").status == 200


@pytest.mark.parametrize("switch, opened", [("", True), ("1", True), ("page", False)])
def test_the_browser_opens_where_there_is_a_screen(monkeypatch: pytest.MonkeyPatch, switch: str, opened: bool) -> None:
    pytest.importorskip("viser")
    urls: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: urls.append(url))
    monkeypatch.setenv(windows.SWITCH, switch)
    monkeypatch.setenv("DISPLAY", ":99")
    client = p.connect(p.GUI)
    url = page_of(client).viewer.url
    if opened:
        until(lambda: urls == [url])
    p.disconnect(client)
    assert bool(urls) == opened


def test_keys_and_clicks_of_the_page_are_events(shown: int) -> None:
    page = page_of(shown)
    assert p.getKeyboardEvents(physicsClientId=shown) == {}
    assert p.getMouseEvents(physicsClientId=shown) == ()
    until(lambda: page._keys._listens and page._mouse._listens)
    page._keys.press(p.B3G_LEFT_ARROW)
    told: list[int] = []
    until(lambda: told.append(p.getKeyboardEvents(physicsClientId=shown).get(p.B3G_LEFT_ARROW, 0)) or told[-1] & 4)
    assert told[0] & p.KEY_WAS_TRIGGERED
    page._mouse.click(512, 192)
    events = p.getMouseEvents(physicsClientId=shown)
    assert [event[1:3] for event in events] == [(512, 192)] * 2


def test_dragging_on_the_page_moves_a_body(shown: int) -> None:
    page, cube = page_of(shown), box(shown, at=(0, 0, 1))
    until(lambda: len(page.viewer.stage.index) == 2)
    link = next(name for name in page.viewer.stage.index if name.startswith(f"b{cube}/"))

    class Drag:
        phase, client_id = "update", 0
        start_position, end_position = (0.0, 0.0, 1.0), (0.0, 0.0, 1.5)

    page.viewer._on_drag(link, Drag())

    def is_there() -> bool:
        p.stepSimulation(physicsClientId=shown)
        return np.allclose(position(shown, cube), Drag.end_position, atol=0.01)

    until(is_there)
    p.configureDebugVisualizer(p.COV_ENABLE_MOUSE_PICKING, 0, physicsClientId=shown)
    until(lambda: not page.viewer.source._holds)
    p.configureDebugVisualizer(p.COV_ENABLE_MOUSE_PICKING, 1, physicsClientId=shown)
    until(lambda: page.viewer.source._holds)
    Drag.phase = "end"
    page.viewer._on_drag(link, Drag())
    until(lambda: not page.viewer.source.pushes and not page.viewer.source._holds)
    Drag.phase = "start"
    page.viewer._on_drag("a link that has just gone", Drag())
    time.sleep(0.3)
    assert not page.viewer.source.pushes and not page.viewer.player.problem


def test_a_program_in_threads_loads_steps_and_draws_while_it_is_shown(shown: int) -> None:
    """Nobody crashes, waits, or shows what is gone."""
    ended, failures = time.perf_counter() + 2.0, []

    def work(body: Callable[[], None]) -> None:
        try:
            while time.perf_counter() < ended:
                body()
        except Exception as reason:
            failures.append(reason)

    def come_and_go() -> None:
        cube = box(shown, at=(0, 0, 5))
        p.addUserDebugLine([0, 0, 0], [0, 0, 1], lifeTime=0.05, parentObjectUniqueId=cube, physicsClientId=shown)
        p.removeBody(cube, physicsClientId=shown)

    threads = [
        threading.Thread(target=work, args=(act,))
        for act in (lambda: p.stepSimulation(physicsClientId=shown), come_and_go)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
    page = page_of(shown)
    until(lambda: len(page.viewer.stage.index) == 1)
    assert not page.viewer.player.problem


def test_the_page_goes_with_its_client(shown: int) -> None:
    viewer = page_of(shown).viewer
    p.disconnect(shown)
    assert viewer.is_closed and windows.page(shown) is None
    again = p.connect(p.GUI)
    assert again == shown and not page_of(again).viewer.is_closed
    p.disconnect(again)


@pytest.mark.parametrize("page", ["0", "1"])
def test_a_program_that_just_ends_ends(page: str) -> None:
    ended = run_program(
        f"c = p.connect(p.GUI); p.loadURDF({PANDA!r}, useFixedBase=True)\n"
        "p.setRealTimeSimulation(1)\n"
        "import time; time.sleep(0.3)",
        page,
    )
    assert ended.returncode == 0 and not ended.stderr, ended.stderr
    assert len(ended.stdout.splitlines()) == int(page)  # the page's address
