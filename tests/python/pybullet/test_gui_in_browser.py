"""Windows of clients in a real browser: what people see and do there."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browsed import number_box, on_page, pixels, show, until
from gui_clients import page_of

import manyhands.pybullet as p
from manyhands.pybullet import gui as windows


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch, page: Any) -> Iterator[int]:
    """A cube of 0.2 m on a floor, before the camera."""
    monkeypatch.setenv(windows.SWITCH, "page")
    client = p.connect(p.GUI)
    p.setGravity(0, 0, -9.81)
    floor = p.createCollisionShape(p.GEOM_BOX, halfExtents=[50, 50, 1])
    p.createMultiBody(0, floor, -1, [0, 0, -1])
    cube = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.1] * 3)
    p.createMultiBody(1, cube, -1, [0, 0, 0.1])
    p.resetDebugVisualizerCamera(1, 0, -20, [0, 0, 0.2])
    viewer = page_of(client).viewer
    until(lambda: len(viewer.stage.index) == 3)
    show(page, viewer)
    until(lambda: p.getDebugVisualizerCamera()[0] < 600)  # the browser has told of its size
    yield client
    page.goto("about:blank")
    p.disconnect(client)


def height() -> float:
    return p.getBasePositionAndOrientation(1)[0][2]


def test_sliders_and_buttons_are_read(shown: int, page: Any) -> None:
    slider, button = p.addUserDebugParameter("speed", 0, 5, 2), p.addUserDebugParameter("Go", 1, 0, 0)
    box = number_box(page, "speed")
    assert box.input_value() == "2"
    box.fill("3.5")
    box.press("Enter")
    until(lambda: p.readUserDebugParameter(slider) == 3.5)
    for presses in (1, 2):
        page.get_by_role("button", name="Go", exact=True).click()
        until(lambda presses=presses: p.readUserDebugParameter(button) == presses)
    p.removeAllUserParameters()
    page.get_by_text("speed").wait_for(state="detached")


def test_lines_are_seen_until_they_are_taken_away(shown: int, page: Any, tmp_path: Path) -> None:
    def reds() -> int:
        shown = pixels(page, tmp_path / "lines.png").astype(int)
        return int(((shown[..., 0] > 150) & (shown[..., 1:].max(-1) < 90)).sum())

    until(lambda: pixels(page, tmp_path / "lines.png").any())
    assert reds() == 0
    line = p.addUserDebugLine([-0.3, 0, 0.3], [0.3, 0, 0.3], [1, 0, 0], 4)
    until(lambda: reds() > 300)
    p.removeUserDebugItem(line)
    until(lambda: reds() == 0)


def test_keys_are_events(shown: int, page: Any) -> None:
    p.getKeyboardEvents()
    until(lambda: page_of(shown)._keys._listens)
    for name, code in (("k", ord("k")), ("ArrowLeft", p.B3G_LEFT_ARROW), ("Enter", p.B3G_RETURN)):
        told: list[int] = []

        def press(name: str = name, code: int = code, told: list[int] = told) -> bool:
            page.keyboard.press(name)
            told.append(p.getKeyboardEvents().get(code, 0))
            return bool(told[-1])

        until(press)
        assert told[-1] & p.KEY_IS_DOWN


def test_a_click_tells_the_pixel_of_what_is_there(shown: int, page: Any) -> None:
    """A program that casts the ray of the pixel, as PyBullet's examples do, hits what was clicked."""
    p.getMouseEvents()
    until(lambda: page_of(shown)._mouse._listens)
    events: list[Any] = []
    for place, body in (((0.08, -0.1, 0.18), 1), ((0.3, 0.2, 0.0), 0)):
        before = events[-1][1:3] if events else None

        def click(place: Any = place, before: Any = before) -> bool:
            """Whether the click was told: a slow page still tells earlier ones, at the pixel before."""
            page.mouse.click(*on_page(page_of(shown).viewer, page, place))
            events.extend(event for event in p.getMouseEvents() if event[1:3] != before)
            return bool(events) and events[-1][1:3] != before

        until(click)
        _, x, y, _, _ = events[-1]
        wide, high, *_, ahead, across, upwards, _, _, distance, target = (
            np.array(part) for part in p.getDebugVisualizerCamera()
        )
        eye = target - distance * ahead
        way = 1e4 * ahead + (x / wide - 0.5) * across + (0.5 - y / high) * upwards
        ((hit, _, _, point, _),) = p.rayTest(eye, eye + way)
        assert hit == body
        np.testing.assert_allclose(point, place, atol=0.02)


def test_a_body_is_dragged(shown: int, page: Any) -> None:
    x, y = on_page(page_of(shown).viewer, page, [0, -0.1, 0.1])
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(x, y - 8 * k)
        page.wait_for_timeout(100)
    until(lambda: page_of(shown).viewer.source._holds)

    def rises() -> bool:
        p.stepSimulation()
        return height() > 0.2

    until(rises)
    page.mouse.up()
    until(lambda: not page_of(shown).viewer.source._holds)

    def falls() -> bool:
        p.stepSimulation()
        return height() < 0.12

    until(falls)


def test_the_camera_is_turned_by_people_and_by_the_program(shown: int, page: Any) -> None:
    camera = page_of(shown).viewer.server.get_clients

    def seen() -> np.ndarray:
        yaw, pitch, distance, target = p.getDebugVisualizerCamera()[8:]
        return np.array([yaw, pitch, distance, *target])

    def is_still() -> bool:  # the page lets a drag run out, and tells of it later
        now = seen()
        page.wait_for_timeout(300)
        return bool(np.array_equal(seen(), now))

    before = p.getDebugVisualizerCamera()[8:10]
    page.mouse.move(60, 400)
    page.mouse.down()
    page.mouse.move(160, 400, steps=5)
    page.mouse.up()
    until(lambda: abs(p.getDebugVisualizerCamera()[8] - before[0]) > 5)
    until(is_still)
    assert p.getDebugVisualizerCamera()[10] == pytest.approx(1, abs=1e-3)
    p.resetDebugVisualizerCamera(2, 90, 0, [0, 0, 1])
    until(lambda: np.allclose(next(iter(camera().values())).camera.position, [2, 0, 1], atol=1e-3))
    until(lambda: np.allclose(seen(), [90, 0, 2, 0, 0, 1], atol=1e-3))
    assert is_still(), "the page stays where the program put it"
    assert seen() == pytest.approx([90, 0, 2, 0, 0, 1], abs=1e-3)


def test_the_program_goes_on_when_the_page_is_closed(shown: int, page: Any) -> None:
    page.goto("about:blank")
    until(lambda: not page_of(shown).viewer.server.get_clients())
    start = p.addUserDebugParameter("later", 0, 1, 0.5)
    for _ in range(240):
        p.stepSimulation()
    assert height() == pytest.approx(0.1, abs=1e-3)
    assert p.readUserDebugParameter(start) == 0.5
    show(page, page_of(shown).viewer)  # and opened again
    page.get_by_text("later").wait_for()
