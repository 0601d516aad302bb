"""The viewer without a browser: its clock, its joints, its shapes and its door."""

import http.client
import re
import shlex
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import pytest

import manyhands as mh
from manyhands.envs.single import ArmEnv
from manyhands.measures import chain, contact_forces, hand_of, joint_forces, rotate
from manyhands.plots import plot
from manyhands.recording import Recorder
from manyhands.viewer import Viewer, controls, shapes
from manyhands.viewer.environments import DropInSource, NativeSource, source_of_environment
from manyhands.viewer.episodes import EpisodeWriter
from manyhands.viewer.history import History
from manyhands.viewer.joints import JointDrive
from manyhands.viewer.player import Frame, Player
from manyhands.viewer.robot_panel import labels
from manyhands.viewer.sources import Push, WorldSource

_REGISTRY = dict(gymnasium.registry)
from manyhands.panda_gym import registration  # noqa: E402

gymnasium.registry.update(_REGISTRY)  # other tests make the environments of manyhands.envs

READY = [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.02, 0.02]


def panda() -> mh.World:
    return mh.World.from_file(mh.asset_path("panda/panda.urdf"))


def ready(world: mh.World) -> JointDrive:
    """A Panda that its motors hold before the table."""
    drive = JointDrive(world)
    drive.move(dict(zip([knob.name for knob in drive.knobs], READY, strict=True)), place=True)
    return drive


def falling_ball() -> mh.World:
    world = mh.World()
    world.add_plane("floor")
    world.add_sphere("ball", 0.05, mass=0.2, position=[0, 0, 1.0])
    return world


def until(condition: object, seconds: float = 5.0) -> None:
    """Waits until a callable is true."""
    assert callable(condition)
    deadline = time.perf_counter() + seconds
    while not condition():
        assert time.perf_counter() < deadline, "it did not come about"
        time.sleep(0.01)


# ---- shapes ------------------------------------------------------------------------------------------------------


def volume(surface: shapes.Surface) -> float:
    a, b, c = (surface.vertices[surface.triangles[:, k]].astype(np.float64) for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


@pytest.mark.parametrize(
    ("shape", "size", "expected"),
    [
        ("box", [0.1, 0.2, 0.3], 8 * 0.1 * 0.2 * 0.3),
        ("sphere", [0.3, 0, 0], 4 / 3 * np.pi * 0.3**3),
        ("cylinder", [0.2, 0.5, 0], np.pi * 0.2**2 * 1.0),
        ("capsule", [0.2, 0.5, 0], np.pi * 0.2**2 * 1.0 + 4 / 3 * np.pi * 0.2**3),
    ],
)
def test_shapes_enclose_their_volume(shape: str, size: list[float], expected: float) -> None:
    assert volume(shapes.primitive(shape, np.array(size))) == pytest.approx(expected, rel=0.01)


def test_light_passes_smoothly_over_flat_edges_only() -> None:
    # Each corner of a box belongs to three sides; a sphere's points are shared by all triangles about them.
    assert len(shapes.primitive("box", np.ones(3)).vertices) == 24
    sphere = shapes.primitive("sphere", np.array([1.0, 0, 0]))
    assert len(np.unique(sphere.vertices.round(5), axis=0)) == len(sphere.vertices)
    cylinder = shapes.primitive("cylinder", np.array([0.5, 1.0, 0]))
    rim = cylinder.vertices[np.isclose(cylinder.vertices[:, 2], 1.0) & (np.hypot(*cylinder.vertices.T[:2]) > 0.4)]
    assert len(rim) == 2 * len(np.unique(rim.round(5), axis=0))  # once for the cap, once for the side


def test_meshes_keep_their_triangles() -> None:
    world = panda()
    for mesh in world.model.meshes[:6]:
        surface = shapes.creased(mesh.vertices, mesh.triangles)
        before, after = mesh.vertices[mesh.triangles], surface.vertices[surface.triangles]
        assert len(after) <= len(before)
        assert volume(surface) == pytest.approx(volume(shapes.Surface(mesh.vertices, mesh.triangles)), rel=1e-5)


# ---- joints ------------------------------------------------------------------------------------------------------


def test_the_hand_is_found() -> None:
    model = panda().model
    assert hand_of(model) == "panda_grasptarget"
    assert len(chain(model, "panda_grasptarget")) == 7
    assert hand_of(falling_ball().model) is None


def test_motors_bring_joints_to_their_targets_and_hold_the_others() -> None:
    world = panda()
    drive = ready(world)
    assert not world.v.any()
    drive.move({"panda_joint1": 0.5})
    world.step(1000)
    assert drive.value(drive.knobs[0]) == pytest.approx(0.5, abs=2e-3)
    assert np.abs(world.q[1:7] - READY[1:7]).max() < 5e-3
    with pytest.raises(KeyError):
        drive.move({"nothing": 1.0})


def test_fingers_move_together() -> None:
    world = panda()
    drive = ready(world)
    drive.grip(1.0)
    assert drive.opening == 1.0
    world.step(500)
    assert np.allclose(world.q[7:9], 0.04, atol=1e-3)
    drive.move({"panda_finger_joint1": 0.01})
    assert drive.target("panda_finger_joint2") == pytest.approx(0.01)


def test_the_hand_reaches_a_pose_that_is_dragged() -> None:
    world = panda()
    drive = ready(world)
    position, quaternion = world.body_pose("panda_grasptarget")
    wanted = position + np.array([0.05, -0.1, 0.08])
    assert drive.reach("panda_grasptarget", wanted, quaternion, place=True)
    assert np.allclose(world.body_pose("panda_grasptarget")[0], wanted, atol=1e-4)
    assert not drive.reach("panda_grasptarget", np.array([3.0, 0, 0]), quaternion)


def test_sliders_leave_out_the_name_that_all_joints_share() -> None:
    for names, words in (
        (["panda_joint1", "panda_finger_joint1"], ["joint1", "finger joint1"]),
        (["arm6_joint1", "arm6_joint2"], ["joint1", "joint2"]),
        (["joint_1", "joint_2"], ["joint 1", "joint 2"]),
        (["left/shoulder_pan", "left/elbow"], ["shoulder pan", "elbow"]),
        (["door_hinge"], ["door hinge"]),
        ([], []),
    ):
        assert labels(names) == words


def test_position_actuators_are_told_by_ctrl() -> None:
    model, _ = (
        mh.load_mjcf_string("""<mujoco><worldbody><body><joint name="j" type="hinge" axis="0 0 1" range="-90 90"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0"/></body></worldbody>
      <actuator><position name="a" joint="j" kp="20" kv="2" gear="2"/></actuator></mujoco>""")
    )
    world = mh.World(model)
    drive = JointDrive(world)
    drive.move({"j": 0.4})
    assert world.ctrl[0] == pytest.approx(0.8)
    world.step(3000)
    assert world.q[0] == pytest.approx(0.4, abs=1e-2)


def test_measured_joint_forces_carry_the_arm() -> None:
    world = panda()
    ready(world)
    world.step(1500)
    weight = mh.dynamics.rnea(world.model, world.q, np.zeros(world.model.nv), np.zeros(world.model.nv))
    assert np.allclose(joint_forces(world)[:7], weight[:7], atol=0.05)


def test_contact_forces_are_the_weight() -> None:
    world = falling_ball()
    world.set_body_pose("ball", [0, 0, 0.05])
    world.step(300)
    assert contact_forces(world)["ball"] == pytest.approx(0.2 * 9.81, rel=1e-3)


# ---- the clock ---------------------------------------------------------------------------------------------------


class Handle:
    """A slider of the page: what its user enters is there before anybody is told."""

    value = 0.0

    def on_update(self, tell: Any) -> None:
        self.tell = tell


def test_what_is_entered_is_not_overwritten(monkeypatch: pytest.MonkeyPatch) -> None:
    handle, entered = Handle(), []
    slider = controls.SharedSlider(handle, entered.append)
    slider.show(0.3)
    assert handle.value == 0.3
    handle.value = 0.8
    slider.show(0.3)
    assert handle.value == 0.8
    handle.tell(SimpleNamespace(client_id=1))
    assert entered == [0.8]
    slider.show(0.3)  # nor shortly after
    assert handle.value == 0.8
    monkeypatch.setattr(controls, "_TOUCHED_FOR", 0.0)
    slider.show(0.3)
    assert handle.value == 0.3
    handle.tell(SimpleNamespace(client_id=None))  # what the simulation shows is not entered
    assert entered == [0.8]


def test_history_goes_back_to_the_last_state_before() -> None:
    history = History(5)
    for k in range(10):
        history.add(k * 0.1, k)
    assert history.span == pytest.approx((0.5, 0.9))
    assert [entry[1] for moment in (0.0, 0.5, 0.64, 0.9, 7.0) if (entry := history.at(moment))] == [5, 5, 6, 9, 9]
    history.add(0.62, "again")
    assert history.span[1] == 0.62


@pytest.fixture
def frames() -> list[Frame]:
    return []


@pytest.fixture
def player(frames: list[Frame]) -> Iterator[Player]:
    player = Player(WorldSource(falling_ball()), frames.append, fps=60)
    player.start()
    yield player
    player.close()


def test_time_passes_only_when_it_is_played(player: Player) -> None:
    time.sleep(0.1)
    assert player.source.time == 0
    player.step(3)
    until(lambda: player.source.time > 0)
    time.sleep(0.1)
    assert player.source.time == pytest.approx(3 * player.source.dt)
    player.playing = True
    start, simulated = time.perf_counter(), player.source.time
    time.sleep(0.5)
    player.playing = False
    time.sleep(0.05)
    assert player.source.time - simulated == pytest.approx(time.perf_counter() - start, abs=0.25)
    stopped = player.source.time
    time.sleep(0.1)
    assert player.source.time == stopped


def test_rewinding_and_playing_on_gives_the_same_bits(player: Player) -> None:
    world = player.source.world
    assert world is not None
    player.speed, player.playing = 5.0, True
    until(lambda: player.source.time > 0.8)
    player.playing = False
    player.do(lambda: None, wait=2.0)
    end, hash_there = world.time, world.state_hash()
    player.rewind(0.3)
    player.do(lambda: None, wait=2.0)
    assert 0.3 - 0.1 < world.time <= 0.3
    steps = round((end - world.time) / world.time_step)
    player.step(steps)
    until(lambda: world.time >= end - 1e-9)
    time.sleep(0.05)
    assert world.state_hash() == hash_there


def test_a_reset_can_be_rewound(player: Player) -> None:
    player.speed, player.playing = 5.0, True
    until(lambda: player.source.time > 0.5)
    player.restart()
    until(lambda: player.source.time < 0.2)
    assert player.moment > 0.5
    player.rewind(0.4)
    player.do(lambda: None, wait=2.0)
    assert 0.3 < player.source.time <= 0.4


def test_a_loop_that_syncs_keeps_real_time_and_waits_while_paused(player: Player, frames: list[Frame]) -> None:
    world = player.source.world
    assert world is not None
    start = time.perf_counter()
    for _ in range(100):
        world.step()
        player.sync()
    assert time.perf_counter() - start > 0.18
    assert len(frames) < 30
    player.playing = False
    went_on = threading.Event()
    loop = threading.Thread(target=lambda: (world.step(), player.sync(), went_on.set()), daemon=True)
    loop.start()
    assert not went_on.wait(0.3)
    player.step()
    assert went_on.wait(2.0)


def test_a_page_that_hangs_does_not_hold_up_a_loop() -> None:
    release = threading.Event()
    player = Player(WorldSource(falling_ball()), lambda _: release.wait(20.0) and None, fps=60)
    player.speed = float("inf")
    player.start()
    start = time.perf_counter()
    world = player.source.world
    assert world is not None
    for _ in range(2000):
        world.step()
        player.sync()
    taken = time.perf_counter() - start
    release.set()
    player.close()
    assert taken < 2.0


def test_a_world_that_explodes_stops_and_says_why(player: Player) -> None:
    world = player.source.world
    assert world is not None

    def throw() -> None:
        world.set_body_velocity("ball", velocity=[1e200, 0, 0])

    player.do(throw, wait=2.0)
    player.playing = True
    until(lambda: player.problem != "")
    assert not player.playing
    player.restart()
    until(lambda: player.problem == "")
    assert world.time == 0


@pytest.mark.parametrize("problem", [TypeError("of a policy"), PermissionError("no room for a file"), IndexError()])
def test_whatever_is_raised_stops_and_the_page_stays_alive(player: Player, problem: Exception) -> None:
    def fail() -> None:
        raise problem

    player.do(fail, wait=2.0)
    until(lambda: player.problem == (str(problem) or "IndexError()"))
    player.problem, player.playing = "", True
    player.source.step = fail
    until(lambda: player.problem != "")
    assert not player.playing
    del player.source.step
    player.restart()
    player.playing = True
    until(lambda: player.source.time > 0)


def test_a_frame_that_cannot_be_drawn_stops_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    drawn: list[Frame] = []

    def draw(frame: Frame) -> None:
        drawn.append(frame)
        if len(drawn) < 3:
            raise KeyError("a body that is gone")

    player = Player(WorldSource(falling_ball()), draw)
    player.start()
    try:
        player.playing = True
        until(lambda: len(drawn) > 5)
        assert player.source.time > 0
    finally:
        player.close()
    assert capsys.readouterr().err.count("KeyError: 'a body that is gone'") == 1  # said, but not thirty times a second


# ---- environments ------------------------------------------------------------------------------------------------


def test_pushes_act_in_every_time_step_of_an_environment() -> None:
    env = registration.make_env(**registration.VARIANTS["PandaPush"])
    env.reset(seed=0)
    source = source_of_environment(env)
    assert isinstance(source, DropInSource)
    source.policy = lambda _: np.zeros(3)
    before = env.sim.get_base_position("object")
    source.pushes["mouse"] = Push("object", np.zeros(3), np.array([0, 0, 2 * 9.81]))  # twice its weight
    for _ in range(5):
        source.step()
    # Up with 1 g for 0.2 s.
    assert env.sim.get_base_position("object")[2] - before[2] == pytest.approx(0.5 * 9.81 * 0.2**2, rel=0.05)


def test_environments_go_back_with_their_goals() -> None:
    for env in (registration.make_env(task="PandaReach"), ArmEnv("PandaReach")):
        env.reset(seed=3)
        source = source_of_environment(env)
        assert source is not None
        source.policy = lambda _: np.array([1.0, 0.0, 0.5])
        source.reset(seed=1)
        saved = source.save()
        for _ in range(4):
            source.step()
        end = source.outcome
        source.reset()
        source.restore(saved)
        assert source.outcome.length == 0
        for _ in range(4):
            source.step()
        for key in end.observation:
            assert np.array_equal(source.outcome.observation[key], end.observation[key])
        assert source.time == pytest.approx(0.16)


def test_goals_are_seen() -> None:
    for task, count in (("PandaReach", 1), ("PandaStack", 2), ("PandaFlip", 1), ("PandaSlide", 1)):
        env = ArmEnv(task)
        observation, _ = env.reset(seed=0)
        source = source_of_environment(env)
        assert isinstance(source, NativeSource)
        markers = source.markers()
        assert len(markers) == count
        goal = observation["desired_goal"]
        if task == "PandaFlip":
            assert np.allclose(markers[0].quaternion, goal)
        else:
            assert np.allclose([marker.position for marker in markers], goal.reshape(count, 3))
        assert any(geom.is_visual for geom in source.model.geoms)


def test_goals_lie_as_their_objects_do() -> None:
    env = ArmEnv("PandaPush", object_shape="capsule")
    env.reset(seed=0)
    source = source_of_environment(env)
    assert source is not None
    (marker,) = source.markers()
    assert marker.shape == "capsule"
    assert abs(rotate(marker.quaternion, np.array([0.0, 0.0, 1.0]))[0]) == pytest.approx(1)


def test_native_bodies_are_where_they_are_observed() -> None:
    env = ArmEnv("PandaPush")
    observation, _ = env.reset(seed=0)
    source = source_of_environment(env)
    assert source is not None
    positions, _ = source.poses()
    names = [link.name for link in source.model.links]
    assert np.allclose(positions[names.index("object")], observation["achieved_goal"], atol=1e-6)
    assert np.allclose(positions[names.index("panda_grasptarget")], observation["observation"][:3], atol=2e-3)


def test_episodes_are_written_as_they_happened(tmp_path: Path) -> None:
    env = ArmEnv("PandaReach")
    env.spec = gymnasium.spec("PandaReach-v3")
    source = source_of_environment(env, title="reaching (slowly)")
    assert source is not None
    writer = EpisodeWriter(source, tmp_path)
    expert = mh.envs.Expert("PandaReach-v3")
    source.policy = lambda outcome: expert(outcome.observation)
    source.reset(seed=5)
    writer.start()
    while not source.outcome.success:
        source.step()
    writer.stop()
    assert writer.where is not None
    assert writer.where.name.startswith("PandaReach-v3-")
    episode = np.load(writer.where)
    assert episode["env_id"] == "PandaReach-v3"
    assert episode["success"][-1] and not episode["success"][:-1].any()
    again = ArmEnv("PandaReach")
    observation, _ = again.reset(seed=5)
    for k, action in enumerate(episode["action"]):
        assert np.array_equal(observation["observation"], episode["observation"][k])
        observation, reward, *_ = again.step(action)
        assert reward == episode["reward"][k]


@pytest.mark.parametrize("make", [ArmEnv, registration.make_env])
def test_human_mode_opens_a_page_and_keeps_time(make: Any, capsys: pytest.CaptureFixture[str]) -> None:
    env = make(task="PandaReach", render_mode="human")
    env.reset(seed=0)
    start = time.perf_counter()
    for _ in range(6):
        env.step(env.action_space.sample())
    assert time.perf_counter() - start > 0.2
    address = next(word for word in capsys.readouterr().out.split() if word.startswith("http://"))
    host = address.removeprefix("http://").rstrip("/")
    connection = http.client.HTTPConnection(host.replace("localhost", "127.0.0.1"), timeout=5)
    connection.request("GET", "/")
    assert connection.getresponse().status == 200
    connection.close()
    start = time.perf_counter()
    env.close()
    assert time.perf_counter() - start < 5.0
    with pytest.raises(OSError):
        http.client.HTTPConnection(host.replace("localhost", "127.0.0.1"), timeout=1).request("GET", "/")


# ---- the door ----------------------------------------------------------------------------------------------------


def answer(viewer: Viewer, path: str = "/", **headers: str) -> tuple[int, dict[str, str]]:
    """Status and headers of a request; `upgrade` asks for a socket."""
    connection = http.client.HTTPConnection("127.0.0.1", viewer.server.get_port(), timeout=5)
    if headers.pop("upgrade", ""):
        headers |= {
            "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": f"viser-v{_viser_version()}",
        }  # fmt: skip
    connection.request("GET", path, headers=headers)
    response = connection.getresponse()
    given = dict(response.getheaders())
    connection.close()
    return response.status, given


def _viser_version() -> str:
    import viser

    return viser.__version__


@pytest.fixture(scope="module")
def here() -> Iterator[Viewer]:
    with Viewer(falling_ball(), port=18410, announce=False) as viewer:
        yield viewer


@pytest.fixture(scope="module")
def guarded() -> Iterator[Viewer]:
    with Viewer(falling_ball(), port=18420, token="open sesame!", announce=False) as viewer:
        yield viewer


def test_this_machine_needs_no_token(here: Viewer) -> None:
    own = f"http://127.0.0.1:{here.server.get_port()}"
    assert answer(here)[0] == 200
    assert answer(here, upgrade="yes", Origin=own)[0] == 101
    assert answer(here, upgrade="yes")[0] == 101


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://localhost:1", "null", "https://127.0.0.1.evil.example"]
)
def test_a_foreign_page_is_refused(here: Viewer, origin: str) -> None:
    assert answer(here, upgrade="yes", Origin=origin)[0] == 403
    assert answer(here, Origin=origin)[0] == 403


def test_a_foreign_name_for_this_machine_is_refused(here: Viewer) -> None:
    # DNS rebinding: the page's origin and the host agree, but neither is ours.
    assert answer(here, upgrade="yes", Host="evil.example:18410", Origin="http://evil.example:18410")[0] == 403


def test_a_token_opens_and_a_cookie_keeps_open(guarded: Viewer) -> None:
    own = f"http://127.0.0.1:{guarded.server.get_port()}"
    assert answer(guarded)[0] == 403
    assert answer(guarded, upgrade="yes", Origin=own)[0] == 403
    assert answer(guarded, "/?token=wrong")[0] == 403
    status, headers = answer(guarded, "/?token=open%20sesame!")
    assert status == 200
    cookie = headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and "sesame" not in cookie
    shown = cookie.partition(";")[0]
    assert answer(guarded, upgrade="yes", Origin=own, Cookie=shown)[0] == 101
    # A foreign page cannot use the cookie, nor can a cookie of another token.
    assert answer(guarded, upgrade="yes", Origin="http://localhost:1", Cookie=shown)[0] == 403
    assert answer(guarded, upgrade="yes", Origin=own, Cookie=shown[:-3] + "abc")[0] == 403


def test_other_addresses_get_a_token_by_themselves(capsys: pytest.CaptureFixture[str]) -> None:
    with Viewer(falling_ball(), host="0.0.0.0", port=18430) as viewer:
        assert "?token=" in viewer.url
        assert viewer.url in capsys.readouterr().out
        assert answer(viewer)[0] == 403
        assert answer(viewer, "/?" + viewer.url.partition("?")[2])[0] == 200


def test_pages_are_not_shared_with_the_world(here: Viewer) -> None:
    from viser import _messages

    assert _messages.ShareUrlRequest not in here.server._websock_server._incoming_handlers


# ---- the viewer and its command ----------------------------------------------------------------------------------


def test_what_cannot_be_shown_is_refused() -> None:
    with pytest.raises(TypeError, match="expected a World or an environment"):
        Viewer(object(), announce=False)
    with pytest.raises(ValueError, match="fps"):
        Viewer(falling_ball(), fps=0, announce=False)
    for port in ("x", -1, 2**16):
        with pytest.raises(ValueError, match="port is"):
            Viewer(falling_ball(), port=port, announce=False)  # pyright: ignore[reportArgumentType]


def test_a_stretched_robot_is_seen_to_its_end() -> None:
    """Its last link is long, and only its shape tells."""
    box = '<geom type="box" size="0.25 0.03 0.03" pos="0.25 0 0"/>'
    link = f'<body pos="0.5 0 0"><joint axis="0 1 0"/>{box}</body>'
    scene = f'<mujoco><worldbody><body pos="0 0 0.3"><joint/>{box}{link}</body></worldbody></mujoco>'
    world = mh.World(mh.load_mjcf_string(scene)[0])
    with Viewer(world, port=18450, announce=False) as viewer:
        eye, look_at = viewer.stage.camera()
        forward = (look_at - eye) / np.linalg.norm(look_at - eye)
        for end in ([0.0, 0.0, 0.3], [1.0, 0.0, 0.3]):
            to = np.array(end) - eye
            assert np.degrees(np.arccos(to @ forward / np.linalg.norm(to))) < 38 / 2


def test_a_port_that_is_taken_is_told(here: Viewer, capsys: pytest.CaptureFixture[str]) -> None:
    taken = here.server.get_port()
    with Viewer(falling_ball(), port=taken) as other:
        assert other.server.get_port() != taken
        assert f"{other.url} (port {taken} is taken)" in capsys.readouterr().out


@pytest.mark.parametrize("package", ["viser", "matplotlib"])
def test_a_missing_package_is_installed_by_what_is_said(
    package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For the Python that runs, and with the packages by their own names: nothing needs to be found by this one's."""
    recording = Recorder(panda())
    recording.add()
    run = recording.recording()
    for name in [*sys.modules]:
        if name.split(".")[0] == package or name.startswith("manyhands.viewer."):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ModuleNotFoundError) as raised:
        if package == "viser":
            mh.view(falling_ball(), announce=False)
        else:
            plot(run, tmp_path / "run.png")
    what, _, command = str(raised.value).partition(": ")
    assert what.endswith(f"needs {package}")
    python, *words, first, second = shlex.split(command)
    assert (python, *words) == (sys.executable, "-m", "pip", "install")
    assert re.match(f"{package}[=>]=", first) and re.match(r"(pillow|plotly)>=", second)


def test_a_recording_is_one_file_with_all_that_moved(here: Viewer, tmp_path: Path) -> None:
    here.speed = 2.0
    here.play()
    until(lambda: here.source.time > 0.5)
    here.pause()
    path = here.save_html(tmp_path / "run.html", seconds=0.4)
    text = path.read_text()
    assert text.startswith("<!") and "__VISER_EMBED_DATA__" in text
    assert "http-equiv" not in text.lower() and 'src="http' not in text


def test_axes_trails_and_plots_are_chosen(here: Viewer) -> None:
    view, graphs, body = here.panel.view, here.panel.graphs, here.stage.index["ball"]
    for name, shown in (("ball", [body]), ("all links", [*here.stage.index.values()]), ("none", [])):
        view._frames.value = name
        until(lambda shown=shown: [k for k, each in enumerate(here.stage._bodies) if each.show_axes] == shown)
    view._trail.value = "ball"
    until(lambda: here.overlays.trails == ["ball"])
    here.plot("height", lambda: here.source.poses()[0][body][2])
    for quantity in ("height", "Energy", "Contact force"):
        graphs._choice.value = quantity
        until(lambda quantity=quantity: list(here.player.watched) == [quantity])
        here.play()
        until(lambda: graphs._plot is not None and len(graphs._rows) > 3)
        here.pause()
    graphs._choice.value = "none"
    view._trail.value = "none"
    until(lambda: not here.player.watched and not here.overlays.trails)
    assert not here.player.problem


def test_cameras_see_the_scene(here: Viewer) -> None:
    cameras = here.panel.cameras
    cameras._choice.value = "front"
    until(lambda: cameras._image.image.shape == (240, 320, 3), 20.0)
    assert cameras._image.image.std() > 5
    cameras._choice.value = "none"


def test_parts_may_come_and_go_while_they_are_seen(here: Viewer) -> None:
    world = here.source.world
    assert world is not None
    here.player.do(lambda: world.add_box("box", [0.1, 0.1, 0.1], mass=1.0, position=[0.5, 0, 0.1]), wait=2.0)
    until(lambda: "box" in here.stage.index)
    here.player.do(lambda: world.remove("box"), wait=2.0)
    until(lambda: "box" not in here.stage.index)
    assert not here.player.problem


@pytest.mark.parametrize("target", ["panda", "PandaReach", "scene.xml"])
def test_the_command_shows_robots_scenes_and_environments(
    target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from manyhands import cli

    if target == "scene.xml":
        path = tmp_path / target
        path.write_text('<mujoco><worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>')
        target = str(path)
    seen: list[Viewer] = []
    monkeypatch.setattr(Viewer, "wait", lambda viewer: seen.append(viewer))
    assert cli.main(["view", target, "--port", "18440"]) == 0
    assert len(seen) == 1
    assert "http://localhost:18" in capsys.readouterr().out


def test_the_command_says_what_it_does_not_know(capsys: pytest.CaptureFixture[str]) -> None:
    from manyhands import cli

    assert cli.main(["view", "PandaRaech"]) == 2
    assert "PandaReach" in capsys.readouterr().err
    assert cli.main(["view", "nowhere.urdf"]) == 2
    assert "nowhere.urdf" in capsys.readouterr().err
    assert cli.main(["view", __file__]) == 2
    assert f"{__file__} is no URDF or MJCF" in capsys.readouterr().err


def test_the_page_leaves_gymnasiums_environments_as_they_are() -> None:
    """Importing the drop-in changes them, in all of a program."""
    code = "import sys, manyhands.viewer.viewer; sys.exit('manyhands.panda_gym' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
