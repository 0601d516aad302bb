"""Environments as the viewer shows them, without a browser."""

import http.client
import time
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import manyhands as mh
from manyhands.envs.single import ArmEnv
from manyhands.measures import rotate
from manyhands.panda_gym import registration
from manyhands.viewer.environments import DropInSource, NativeSource, source_of_environment
from manyhands.viewer.episodes import EpisodeWriter
from manyhands.viewer.sources import Push, WorldSource


def test_pushes_act_in_every_time_step_of_an_environment() -> None:
    env = registration.make_env(**registration.VARIANTS["PandaPush"])
    env.reset(seed=0)
    source = source_of_environment(env)
    assert isinstance(source, DropInSource)
    source.policy = lambda _: np.zeros(3)
    before = env.sim.get_base_position("object")
    source.pushes["mouse"] = Push("object", np.zeros(3), np.array([0, 0, 2 * 9.81]), np.zeros(3))  # twice its weight
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


def test_mocap_bodies_are_shown_where_they_are() -> None:
    text = """<mujoco><worldbody><body name="hand" mocap="true" pos="0 0 1"><geom size="0.1"/>
      <body name="tip" pos="0 0 0.3"><joint/><geom size="0.05"/></body></body></worldbody></mujoco>"""
    world = mh.World(mh.load_mjcf_string(text)[0])
    source = WorldSource(world)
    world.set_mocap("hand", [1, 2, 3], [0, 0, 1, 0])
    positions, quaternions = source.poses()
    names = [link.name for link in world.model.links]
    assert np.allclose(positions[names.index("hand")], [1, 2, 3])
    assert np.allclose(positions[names.index("tip")], [1, 2, 3.3])
    assert np.allclose(quaternions[names.index("tip")], [0, 0, 1, 0])
    assert np.array_equal(source.mocap, world.mocap)
    source.reset()
    assert np.allclose(source.poses()[0][names.index("hand")], [0, 0, 1])


def test_an_environment_on_a_world_is_shown_as_that_world() -> None:
    env = gymnasium.make("KukaReach-v0")
    env.reset(seed=0)
    with mh.view(env, open_browser=False) as viewer:
        assert isinstance(viewer.source, WorldSource) and viewer.source.title == "KukaReach-v0"
        before = viewer.source.q.copy()
        for _ in range(3):
            env.step(np.ones(7))
            viewer.sync()
        assert viewer.source.time == pytest.approx(3 * 0.04)
        assert np.abs(viewer.source.q - before).max() > 0.1
