"""Clients with a window: what they keep in software."""

import math
import re
import time
from collections.abc import Iterator

import numpy as np
import pytest
from gui_clients import PANDA, box, link_of, position, run_program, until

import manyhands.pybullet as p
from manyhands._core import pybullet_gui
from manyhands.pybullet import gui as windows


@pytest.fixture
def window() -> Iterator[int]:
    """Without a page: tests/conftest.py says so."""
    client = p.connect(p.GUI)
    assert windows.page(client) is None
    yield client
    if p.isConnected(client):
        p.disconnect(client)


def test_sliders_and_buttons_are_moved_and_read(window: int) -> None:
    slider = p.addUserDebugParameter("speed", 0, 5, 2, physicsClientId=window)
    button = p.addUserDebugParameter("go", 1, 0, 0, physicsClientId=window)
    assert p.readUserDebugParameter(slider, physicsClientId=window) == 2
    p._set_parameter(window, slider, 3.5)
    p._set_parameter(window, button, 1)
    assert p.readUserDebugParameter(slider, physicsClientId=window) == 3.5
    assert p.readUserDebugParameter(button, physicsClientId=window) == 1
    p._set_parameter(window, slider, 7)
    assert p.readUserDebugParameter(slider, physicsClientId=window) == 5
    line = p.addUserDebugLine([0, 0, 0], [0, 0, 1], physicsClientId=window)
    with pytest.raises(p.error, match="no slider or button"):
        p._set_parameter(window, line, 1)
    p.removeAllUserDebugItems(physicsClientId=window)
    assert p.readUserDebugParameter(slider, physicsClientId=window) == 5
    p.removeAllUserParameters(physicsClientId=window)
    with pytest.raises(p.error, match="Failed to read parameter"):
        p.readUserDebugParameter(slider, physicsClientId=window)


def test_a_client_without_a_window_has_no_keys_to_press() -> None:
    client = p.connect(p.DIRECT)
    with pytest.raises(p.error, match="no window"):
        p._press_key(client, ord("a"))
    p.disconnect(client)
    with pytest.raises(p.error, match="Not connected"):
        p._press_key(client, ord("a"))


def test_keys_are_triggered_down_and_released(window: int) -> None:
    key, keys = ord("a"), lambda: p.getKeyboardEvents(physicsClientId=window)
    assert keys() == {}
    p._press_key(window, key)
    assert keys() == {key: p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED}
    p._press_key(window, key)  # a keyboard repeats it
    assert keys() == {key: p.KEY_IS_DOWN}
    p._press_key(window, key, down=False)
    assert keys() == {key: p.KEY_WAS_RELEASED}
    assert keys() == {}
    p._press_key(window, key)
    p._press_key(window, key, down=False)
    assert keys() == {key: p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED | p.KEY_WAS_RELEASED}
    p._press_key(window, key)
    p._press_key(window, key, down=False)
    p._press_key(window, key)
    assert keys() == {key: p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED}
    assert keys() == {key: p.KEY_IS_DOWN}


def test_the_mouse_moves_and_clicks(window: int) -> None:
    p._move_mouse(window, 10, 20)
    p._click_mouse(window, 0, True, 10, 20)
    p._click_mouse(window, 0, False, 11, 20)
    assert p.getMouseEvents(physicsClientId=window) == (
        (1, 10, 20, -1, 0),
        (2, 10, 20, 0, p.KEY_IS_DOWN | p.KEY_WAS_TRIGGERED),
        (2, 11, 20, 0, p.KEY_WAS_RELEASED),
    )
    assert p.getMouseEvents(physicsClientId=window) == ()


def test_the_camera_is_where_the_program_or_people_put_it(window: int) -> None:
    def orbit() -> tuple[float, ...]:
        yaw, pitch, distance, target = p.getDebugVisualizerCamera(physicsClientId=window)[8:]
        return (distance, yaw, pitch, *target)

    for distance, yaw, pitch in ((3, 30, -40), (1, -120, 10), (2, 0, -89), (2, 180, 0)):
        p.resetDebugVisualizerCamera(distance, yaw, pitch, [0, 1, 2], physicsClientId=window)
        assert orbit() == (distance, yaw, pitch, 0, 1, 2)
        frame = pybullet_gui.frame(window)
        pybullet_gui.set_camera(window, frame.eye, frame.target, frame.camera_moves)
        assert orbit() == (distance, yaw, pitch, 0, 1, 2)  # as it was set, not as it was computed back
        p.resetDebugVisualizerCamera(9, 9, 9, [0, 0, 0], physicsClientId=window)
        pybullet_gui.set_camera(window, frame.eye, frame.target, frame.camera_moves)
        assert orbit() == (9, 9, 9, 0, 0, 0)  # the program has moved it since
        pybullet_gui.set_camera(window, frame.eye, frame.target, frame.camera_moves + 1)
        assert orbit() == pytest.approx((distance, yaw, pitch, 0, 1, 2))
    moves = pybullet_gui.frame(window).camera_moves
    # Yaw turns about z from looking along y, pitch lifts the view: from (0, -1, 0) everything is zero.
    pybullet_gui.set_camera(window, (0, -1, 0), (0, 0, 0), moves)
    assert orbit() == pytest.approx((1, 0, 0, 0, 0, 0))
    pybullet_gui.set_camera(window, (1, 0, 1), (0, 0, 0), moves)
    assert orbit() == pytest.approx((math.sqrt(2), 90, -45, 0, 0, 0))


def test_the_first_camera_is_that_of_pybullets_window(window: int) -> None:
    """Width, height, view and projection as bullet3's issue 2194 has them."""
    camera = p.getDebugVisualizerCamera(physicsClientId=window)
    assert camera[:2] == (1024, 768)
    view = [
        0.6427875,
        -0.4393851,
        0.6275070,
        0,
        0.7660444,
        0.3686878,
        -0.5265408,
        0,
        0,
        0.8191522,
        0.5735765,
        0,
        0,
        0,
        -5,
        1,
    ]
    np.testing.assert_allclose(camera[2], view, atol=1e-6)
    projection = [0.75, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.00002, -1, 0, 0, -0.0200002, 0]
    np.testing.assert_allclose(camera[3], projection, atol=1e-6)
    assert camera[4] == (0, 0, 1) and camera[8:] == (50, -35, 5, (0, 0, 0))


@pytest.mark.parametrize("width, height", [(1024, 768), (900, 300)])
def test_programs_find_the_ray_of_a_pixel(window: int, width: int, height: int) -> None:
    """By what is seen at 10 km, as PyBullet's examples do; by the matrices, the ray's points fall on that pixel."""
    pybullet_gui.set_size(window, width, height)
    p.resetDebugVisualizerCamera(3, 30, -40, [0, 1, 2], physicsClientId=window)
    wide, high, view, projection, _, ahead, across, upwards, _, _, distance, target = (
        np.array(part) for part in p.getDebugVisualizerCamera(physicsClientId=window)
    )
    assert (wide, high) == (width, height)
    x, y = 200, 130
    way = 1e4 * ahead + (x / wide - 0.5) * across + (0.5 - y / high) * upwards
    point = target - distance * ahead + 3e-4 * way
    clip = projection.reshape(4, 4).T @ view.reshape(4, 4).T @ [*point, 1]
    seen = clip[:2] / clip[3]
    np.testing.assert_allclose([(seen[0] + 1) / 2 * wide, (1 - seen[1]) / 2 * high], (x, y), atol=1e-6)


def test_items_follow_their_link_and_their_life_ends(window: int) -> None:
    cube = box(window, at=(1, 0, 1))
    turned = p.getQuaternionFromEuler([0, 0, math.pi / 2])
    p.resetBasePositionAndOrientation(cube, [1, 0, 1], turned, physicsClientId=window)
    tied = p.addUserDebugLine(
        [0, 0, 0], [1, 0, 0], parentObjectUniqueId=cube, parentLinkIndex=-1, physicsClientId=window
    )
    free = p.addUserDebugText("here", [0, 0, 2], physicsClientId=window)
    brief = p.addUserDebugPoints([[0, 0, 0]], [[1, 0, 0]], lifeTime=0.05, physicsClientId=window)
    frame = pybullet_gui.frame(window)
    assert frame.ids == [tied, free, brief]
    items = dict(frame.items)
    np.testing.assert_allclose(items[tied].points, [[1, 0, 1], [1, 1, 1]], atol=1e-12)
    assert [items[number].kind for number in frame.ids] == ["line", "text", "points"]
    # Who has seen it all hears of what moves with a link only.
    assert [number for number, _ in pybullet_gui.frame(window, frame.serial).items] == [tied]
    replaced = p.addUserDebugText("there", [0, 0, 3], replaceItemUniqueId=free, physicsClientId=window)
    assert replaced == free
    assert dict(pybullet_gui.frame(window, frame.serial).items)[free].text == "there"
    until(lambda: pybullet_gui.frame(window).ids == [tied, free])
    p.removeBody(cube, physicsClientId=window)
    assert pybullet_gui.frame(window).ids == [free]
    p.removeUserDebugItem(free, physicsClientId=window)
    assert free not in pybullet_gui.frame(window).ids


def test_what_replaces_a_brief_item_lives_on(window: int) -> None:
    line = p.addUserDebugLine([0, 0, 0], [1, 0, 0], lifeTime=0.02, physicsClientId=window)
    p.addUserDebugLine([0, 0, 0], [2, 0, 0], replaceItemUniqueId=line, physicsClientId=window)
    time.sleep(0.05)
    assert pybullet_gui.frame(window).ids == [line]


def test_frames_tell_of_bodies_that_came_and_went_and_of_colours(window: int) -> None:
    """Between two steps removed parts still lie in the world; frames are without them."""
    cubes = [box(window, at=(k, 0, 1)) for k in range(3)]
    before = pybullet_gui.frame(window)
    p.removeBody(cubes[0], physicsClientId=window)
    p.changeVisualShape(cubes[2], -1, rgbaColor=[0.1, 0.2, 0.3, 0.5], physicsClientId=window)
    frame = pybullet_gui.frame(window, with_model=True)
    assert frame.scene != before.scene and frame.looks != before.looks
    assert frame.model is not None
    names = [link.name for link in frame.model.links]
    assert len(names) == len(frame.positions) == len(before.positions) - 1
    for k in (1, 2):
        (index,) = (i for i, name in enumerate(names) if name.startswith(f"b{cubes[k]}/"))
        np.testing.assert_allclose(frame.positions[index], [k, 0, 1])
    painted = [tuple(np.round(row, 3)) for row in frame.rgba]
    assert painted.count((0.1, 0.2, 0.3, 0.5)) == 1
    seen = [geom.link for geom in frame.model.geoms][painted.index((0.1, 0.2, 0.3, 0.5))]
    assert names[seen].startswith(f"b{cubes[2]}/")
    assert len(pybullet_gui.frame(window, seen_looks=frame.looks, with_model=False).rgba) == 0


def test_frames_leave_the_world_its_bits() -> None:
    """Also where bodies go between two steps."""

    def fall(looks: bool) -> bytes:
        client = p.connect(p.GUI)
        p.setGravity(0, 0, -9.81, physicsClientId=client)
        cubes = [box(client, at=(0.01 * k, 0.02 * k, 0.1 + 0.21 * k)) for k in range(4)]
        numbers: list[float] = []
        for step in range(80):
            if step in (20, 40):
                p.removeBody(cubes.pop(0), physicsClientId=client)
                if looks:
                    pybullet_gui.frame(client)
                cubes.append(box(client, at=(0, 0, 1.5)))
            p.stepSimulation(physicsClientId=client)
            if looks:
                pybullet_gui.frame(client)
        for cube in cubes:
            position, quaternion = p.getBasePositionAndOrientation(cube, physicsClientId=client)
            numbers += [*position, *quaternion]
        p.disconnect(client)
        return np.array(numbers).tobytes()

    assert fall(looks=False) == fall(looks=True)


def test_what_is_held_goes_where_it_is_dragged_until_it_is_let_go(window: int) -> None:
    p.setGravity(0, 0, -9.81, physicsClientId=window)
    cube = box(window, at=(0, 0, 1), mass=2)
    pybullet_gui.hold(
        window, [(link_of(window, cube), (0, 0, 0), (0.3, 0, 1.5)), ("no such link", (0, 0, 0), (9, 9, 9))]
    )
    p.stepSimulation(physicsClientId=window)
    assert np.linalg.norm(np.subtract(position(window, cube), (0, 0, 1))) < 0.1  # it is led there, not put there
    for _ in range(240):
        p.stepSimulation(physicsClientId=window)
    np.testing.assert_allclose(position(window, cube), (0.3, 0, 1.5), atol=1e-3)
    assert p.getNumConstraints(physicsClientId=window) == 0  # it is none of the program's
    pybullet_gui.hold(window, [])
    for _ in range(24):
        p.stepSimulation(physicsClientId=window)
    np.testing.assert_allclose(p.getBaseVelocity(cube, physicsClientId=window)[0], (0, 0, -0.981), atol=5e-3)


def test_nobody_is_strong_enough_to_lift_a_ton(window: int) -> None:
    p.setGravity(0, 0, -10, physicsClientId=window)
    cube = box(window, at=(0, 0, 10), mass=1000)
    p.changeDynamics(cube, -1, linearDamping=0, angularDamping=0, physicsClientId=window)
    pybullet_gui.hold(window, [(link_of(window, cube), (0, 0, 0), (0, 0, 20))])
    for _ in range(240):
        p.stepSimulation(physicsClientId=window)
    # 500 N up, 10 kN down
    assert p.getBaseVelocity(cube, physicsClientId=window)[0][2] == pytest.approx(-9.5, rel=1e-6)


def test_an_arm_follows_the_hand_that_drags_it(window: int) -> None:
    arm = p.loadURDF(PANDA, useFixedBase=True, physicsClientId=window)
    frame = pybullet_gui.frame(window)
    assert frame.model is not None
    names = [link.name for link in frame.model.links]
    hand = next(name for name in names if name.endswith("panda_hand"))
    number = next(
        joint
        for joint in range(p.getNumJoints(arm, physicsClientId=window))
        if p.getJointInfo(arm, joint, physicsClientId=window)[12] == b"panda_hand"
    )
    for joint in range(p.getNumJoints(arm, physicsClientId=window)):
        p.setJointMotorControl2(arm, joint, p.VELOCITY_CONTROL, force=0, physicsClientId=window)
    start = frame.positions[names.index(hand)]
    target = (start + np.array([0.1, 0.1, -0.2])).tolist()
    pybullet_gui.hold(window, [(hand, (0, 0, 0), target)])
    for _ in range(240):
        p.stepSimulation(physicsClientId=window)
    np.testing.assert_allclose(p.getLinkState(arm, number, physicsClientId=window)[4], target, atol=2e-3)


def test_bodies_and_states_come_and_go_while_they_are_held(window: int) -> None:
    cubes = [box(window, at=(k, 0, 1)) for k in range(2)]
    before = p.saveState(physicsClientId=window)
    held = link_of(window, cubes[0])
    pybullet_gui.hold(window, [(held, (0, 0, 0), (0, 0, 2))])
    for _ in range(24):
        p.stepSimulation(physicsClientId=window)
    during = p.saveState(physicsClientId=window)
    raised = position(window, cubes[0])
    assert raised[2] > 1.05
    p.restoreState(before, physicsClientId=window)
    assert position(window, cubes[0]) == (0, 0, 1)
    p.stepSimulation(physicsClientId=window)
    p.restoreState(during, physicsClientId=window)
    assert position(window, cubes[0]) == raised
    p.stepSimulation(physicsClientId=window)
    p.removeBody(cubes[0], physicsClientId=window)
    p.stepSimulation(physicsClientId=window)
    p.resetSimulation(physicsClientId=window)
    p.stepSimulation(physicsClientId=window)
    again = box(window)
    pybullet_gui.hold(window, [(held, (0, 0, 0), (0, 0, math.nan))])
    p.stepSimulation(physicsClientId=window)
    assert position(window, again) == pytest.approx((0, 0, 1))


def test_real_time_passes_by_itself_until_it_is_switched_off(window: int) -> None:
    p.setGravity(0, 0, -10, physicsClientId=window)
    cube = box(window, at=(0, 0, 100))

    def height() -> float:
        return p.getBasePositionAndOrientation(cube, physicsClientId=window)[0][2]

    p.setRealTimeSimulation(1, physicsClientId=window)
    begin = time.perf_counter()
    assert p.getPhysicsEngineParameters(physicsClientId=window)["useRealTimeSimulation"] == 1
    until(lambda: height() < 99.0)
    # 1 m takes 0.45 s; a busy machine is late, but never early.
    assert time.perf_counter() - begin > 0.4
    p.setRealTimeSimulation(0, physicsClientId=window)
    stopped = height()
    time.sleep(0.05)
    assert height() == stopped
    p.setRealTimeSimulation(1, physicsClientId=window)
    p.disconnect(window)  # ends it


def test_real_time_needs_a_window() -> None:
    client = p.connect(p.DIRECT)
    p.setGravity(0, 0, -10, physicsClientId=client)
    cube = box(client)
    p.setRealTimeSimulation(1, physicsClientId=client)
    time.sleep(0.05)
    assert p.getBasePositionAndOrientation(cube, physicsClientId=client)[0] == (0, 0, 1)
    p.disconnect(client)


@pytest.mark.parametrize("page", ["0", "1"])
def test_a_missing_viewer_is_an_error_that_says_what_to_do(page: str) -> None:
    code = "import sys; sys.modules['viser'] = None; p.connect(p.DIRECT); p.connect(p.GUI); print(p.isConnected(1))"
    ended = run_program(code, page)
    if page == "0":
        assert ended.stdout == "1\n"
    else:
        told = ended.stderr.splitlines()[-1]
        assert re.search(r"error: .*needs viser: .* -m pip install .*DIRECT, or set MANYHANDS_PYBULLET_GUI=0", told)
