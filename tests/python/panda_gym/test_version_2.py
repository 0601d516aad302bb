"""Ids in -v2, through Gymnasium and through the old gym; what `render` and `loadURDF` take; pages and pictures."""

import sys
import warnings
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray
from programs import output

import manyhands as mh
from manyhands import gym, panda_gym
from manyhands.panda_gym import registration
from manyhands.panda_gym.envs.core import RobotTaskEnv
from manyhands.panda_gym.pybullet import PyBullet, error

GREEN, RED = (0, 200, 0), (0.8, 0.1, 0.1, 1.0)
V2_IDS = [name.replace("-v3", "-v2") for name in panda_gym.ENV_IDS]


@pytest.fixture(autouse=True)
def registry() -> Iterator[None]:
    """Inside a test, gymnasium knows the drop-in's environments."""
    before = dict(gymnasium.registry)
    registration.register()
    yield
    gymnasium.registry.update(before)


def picture(sim: PyBullet, *args: Any, **kwargs: Any) -> NDArray[Any]:
    seen = sim.render(*args, **kwargs)
    assert seen is not None
    return seen


@pytest.mark.parametrize("name", V2_IDS)
def test_both_gyms_know_an_id(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # Gymnasium names -v3 as the newer
        new = gymnasium.make(name)
    assert isinstance(new.unwrapped, RobotTaskEnv) and new.unwrapped.sim.render_mode == "rgb_array"
    observation, _ = new.reset(seed=3)
    assert new.observation_space.contains(observation)
    old = gym.make(name)
    for key, value in old.reset(seed=3).items():
        assert value.dtype == np.float64
        np.testing.assert_allclose(value, observation[key], atol=1e-6)
    limit = 100 if "Stack" in name else 50
    action = new.action_space.sample()
    for step in range(1, limit + 1):
        observation, reward, terminated, truncated, info = new.step(action)
        seen, old_reward, done, old_info = old.step(action)
        assert not terminated, "episodes of version 2 go on after success"
        assert truncated == done == (step == limit)
        assert old_reward == pytest.approx(reward, abs=2e-6) and bool(old_info["is_success"]) == info["is_success"]
    np.testing.assert_allclose(seen["observation"], observation["observation"], atol=1e-4)
    assert old_info["TimeLimit.truncated"] is True
    new.close()
    old.close()


def test_ids_in_version_2_need_no_drop_in(tmp_path: Path) -> None:
    program = """
        import warnings
        warnings.simplefilter("ignore")
        import gymnasium, manyhands
        env = gymnasium.make("PandaReach-v2")
        assert type(env.unwrapped) is manyhands.envs.ArmEnv
        env.reset(seed=0)
        assert not any(env.step(0 * env.action_space.sample())[2] for _ in range(3))
        envs = gymnasium.make_vec("PandaPushDense-v2", num_envs=2)
        assert envs.reset(seed=0)[0]["observation"].shape == (2, 18)
    """
    output(tmp_path, program)


def test_no_line_changed(tmp_path: Path) -> None:
    """The manual's first example, and its way to look ahead."""
    program = """
        import gym
        import panda_gym

        env = gym.make("PandaReachDense-v2", render=False)
        obs = env.reset()
        done = False
        while not done:
            state = env.save_state()
            action = env.action_space.sample()
            _, reward, _, _ = env.step(action)
            env.restore_state(state)
            env.remove_state(state)
            obs, reward, done, info = env.step(action)
        assert reward == env.task.compute_reward(obs["achieved_goal"], obs["desired_goal"], None)
        print(panda_gym.__name__, info["TimeLimit.truncated"])
        env.close()
    """
    (tmp_path / "program.py").write_text("")
    text = output(tmp_path, program, "-m", "manyhands.compat", "program.py")
    assert text == "manyhands.panda_gym True\n"


def test_an_environment_of_ones_own_in_the_old_manner() -> None:
    def made(render: bool) -> RobotTaskEnv:
        return registration.make_env("PandaReach", render=render)

    gym.register(id="MyReach-v0", entry_point=made, max_episode_steps=2, kwargs={"render": False})
    env = gym.make("MyReach-v0")
    assert set(env.reset()) == {"observation", "achieved_goal", "desired_goal"}
    assert [env.step(np.zeros(3))[2] for _ in range(2)] == [False, True]
    del gym.envs.registry["MyReach-v0"]


def test_render_takes_the_mode_first() -> None:
    sim = PyBullet(render=False)
    sim.create_box("cube", [0.1] * 3, 0.0, [0, 0, 0], rgba_color=RED)
    by_place = picture(sim, "rgb_array", 32, 24, [0, 0, 0.1], 1.0, 30, -20, 5)
    by_name = picture(
        sim, mode="rgb_array", width=32, height=24, target_position=[0, 0, 0.1], distance=1.0, yaw=30, pitch=-20, roll=5
    )
    assert by_place.shape == (24, 32, 3)
    np.testing.assert_array_equal(by_place, by_name)
    later = PyBullet()
    later.create_box("cube", [0.1] * 3, 0.0, [0, 0, 0], rgba_color=RED)
    np.testing.assert_array_equal(picture(later, 32, 24, [0, 0, 0.1], 1.0, 30, -20, 5), by_place)
    assert picture(sim, "rgb_array").shape == (480, 720, 3)
    with pytest.raises(ValueError, match="render_mode is 'ascii'"):
        sim.render("ascii", 32, 24)
    with pytest.raises(TypeError, match="widht"):
        sim.render("rgb_array", widht=32)
    sim.close()
    later.close()


def test_the_background_is_drawn() -> None:
    sim = PyBullet(background_color=np.array(GREEN))
    np.testing.assert_allclose(sim.background_color, np.array(GREEN) / 255)
    assert np.abs(picture(sim, 40, 30).astype(int) - GREEN).max() <= 1
    plain = picture(PyBullet(), 40, 30)
    assert np.abs(plain.astype(int) - (223, 54, 45)).min() > 1, "panda-gym's red is for its window"


def test_highlights_are_drawn() -> None:
    def seen(**color: Any) -> NDArray[Any]:
        sim = PyBullet()
        sim.create_sphere("ball", 0.3, 0.0, [0, 0, 0], rgba_color=RED, **color)
        return picture(sim, 80, 60).astype(int)

    dull, black, white, blue = (
        seen(), seen(specular_color=[0, 0, 0]), seen(specular_color=[1, 1, 1]), seen(specular_color=[0, 0, 1]),
    )  # fmt: skip
    np.testing.assert_array_equal(dull, black)
    bright = (white - dull)[..., 1]  # red is bright already
    assert bright.min() >= 0 and bright.max() > 100
    rows, columns = np.nonzero(bright > 50)
    assert 4 < len(rows) < 200, "a spot"
    np.testing.assert_array_equal((blue - dull)[..., :2], 0)
    # Where the half vector between the eye and the sun is the normal.
    eye = 1.4 * np.array([0.75**0.5 * 0.5**0.5, -(0.75**0.5) * 0.5**0.5, 0.5])
    light = mh.Look().light / np.linalg.norm(mh.Look().light)
    normal = eye / np.linalg.norm(eye) + light
    point = 0.3 * normal / np.linalg.norm(normal)
    camera = mh.Camera.perspective(80, 60, np.radians(60)).orbit([0, 0, 0], 1.4, np.radians(45), np.radians(-30))
    toward = np.linalg.inv(_matrix(camera.quaternion)) @ (point - eye)
    x, y = camera.fx * toward[0] / toward[2] + camera.cx, camera.fy * toward[1] / toward[2] + camera.cy
    assert abs(columns.mean() + 0.5 - x) < 1.5 and abs(rows.mean() + 0.5 - y) < 1.5


def _matrix(quaternion: NDArray[Any]) -> NDArray[Any]:
    x, y, z, w = quaternion
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@pytest.mark.parametrize(
    "options",
    [{"flags": 8}, {"flags": 2 | 131072}, {"flags": 524288}, {"flags": 1 << 30}, {"globalScaling": 2.0}],
)
def test_what_cannot_be_honoured_is_refused(options: dict[str, Any]) -> None:
    sim = PyBullet()
    with pytest.raises(error, match=r"URDF_|no flags|globalScaling"):
        sim.loadURDF("panda", fileName="franka_panda/panda.urdf", useFixedBase=True, **options)
    sim.loadURDF("panda", fileName="franka_panda/panda.urdf", useFixedBase=True)  # the name is free still
    sim.close()


@pytest.mark.parametrize("options", [{"flags": 2048}, {"useMaximalCoordinates": True}])
def test_what_has_no_effect_says_so(options: dict[str, Any]) -> None:
    sim = PyBullet()
    with pytest.warns(UserWarning, match="has no effect here") as said:
        sim.loadURDF("panda", fileName="franka_panda/panda.urdf", useFixedBase=True, **options)
    assert said[0].filename == __file__
    sim.close()


def test_what_is_so_anyway_says_nothing() -> None:
    sim = PyBullet()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sim.loadURDF(
            "panda", fileName="franka_panda/panda.urdf", useFixedBase=True, flags=2 | 128 | 1024, globalScaling=-1,
            useMaximalCoordinates=0,
        )  # fmt: skip
    sim.close()


def test_human_mode_opens_the_browser(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: bool(opened.append(url)))
    monkeypatch.setenv("DISPLAY", ":0")
    sim = PyBullet(render_mode="human", background_color=np.array(GREEN))
    sim.real_time = False
    sim.render()
    sim.render()
    assert len(opened) == 1 and opened[0].startswith("http://localhost:")
    sim.close()
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    sim = PyBullet(render_mode="human")
    sim.render()
    sim.close()
    assert len(opened) == 1, "nobody would see it"


def test_human_mode_shows_itself_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[Any] = []
    ipython: Any = ModuleType("IPython")
    ipython.get_ipython = lambda: SimpleNamespace(kernel=object())
    ipython.display = SimpleNamespace(display=shown.append)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    env = gymnasium.make("PandaReach-v3", render_mode="human")
    env.reset()
    env.unwrapped.sim.real_time = False  # pyright: ignore[reportAttributeAccessIssue]
    env.step(env.action_space.sample())
    env.step(env.action_space.sample())
    (viewer,) = shown
    assert viewer._repr_html_().startswith(f'<iframe src="{viewer.url}"')
    env.close()
