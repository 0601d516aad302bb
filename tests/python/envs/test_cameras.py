"""What environments show: `render`, pictures in the observation, and videos."""

import copy
import gc
import math
import pickle
import weakref
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands._core.render import Look
from manyhands.envs import ArmEnv, ArmVectorEnv
from manyhands.envs.cameras import orbit_camera
from manyhands.envs.spaces import CameraOptions

Array = NDArray[Any]


def test_render_has_panda_gyms_arguments() -> None:
    env = gymnasium.make("PandaPickAndPlace-v3", render_mode="rgb_array")
    env.reset(seed=0)
    frame = env.render()
    assert isinstance(frame, np.ndarray) and frame.shape == (480, 720, 3) and frame.dtype == np.uint8
    small = ArmEnv("PandaPickAndPlace", render_mode="rgb_array", render_width=84, render_height=48)
    small.reset(seed=0)
    picture = small.render()
    assert picture is not None and picture.shape == (48, 84, 3)
    turned = ArmEnv("PandaPickAndPlace", render_mode="rgb_array", render_width=84, render_height=48, render_yaw=90)
    turned.reset(seed=0)
    assert (turned.render() != picture).any()
    with pytest.raises(ValueError, match="render size"):
        ArmEnv(render_mode="rgb_array", render_width=0)


def test_the_floor_of_pictures_has_the_colour_that_is_asked_for() -> None:
    """Videos show it lighter than panda-gym has it; all else, and what cameras observe, stays."""
    options: Any = {"render_mode": "rgb_array", "render_width": 96, "render_height": 64}
    pictures = []
    for floor in (None, (0.9, 0.1, 0.1)):
        env = ArmEnv("PandaPush", cameras={"front": {}}, render_floor=floor, **options)
        observation, _ = env.reset(seed=0)
        pictures.append((env.render(), observation["front"]))
    (plain, seen), (red, seen_too) = pictures
    assert np.array_equal(seen, seen_too)
    corner, middle = (slice(-8, None), slice(0, 8)), (slice(28, 36), slice(44, 52))
    assert plain[corner].mean() < 80
    assert (red[corner][..., 0] > red[corner][..., 1] + 50).all()
    assert np.array_equal(red[middle], plain[middle])
    for floor in ((1, 1), (0, 0, 2), (np.nan, 0, 0)):
        with pytest.raises((TypeError, ValueError), match="render_floor is"):
            ArmEnv(render_floor=floor, **options)


def test_depth_of_the_table_is_where_the_table_is() -> None:
    options = {"render_width": 90, "render_height": 60, "render_target_position": [0.2, -0.2, 0]}
    env = ArmEnv(render_mode="depth_array", **options)  # pyright: ignore[reportArgumentType]
    env.reset(seed=0)
    depth = env.render()
    assert depth is not None and depth.dtype == np.float32
    camera = orbit_camera(90, 60, [0.2, -0.2, 0], 1.4, 45, -30, 0)
    towards = (28.5 - camera.cy) / camera.fy
    # The pixel (45, 28) shows the table: its plane is z = 0, seen from 0.7 m above at 30 degrees.
    down = math.sin(math.radians(30)) + math.cos(math.radians(30)) * towards
    assert depth[28, 45] == pytest.approx(0.7 / down, abs=1e-3)


def test_goals_and_dice_are_seen() -> None:
    """Where the goal is, the picture differs from one of another goal; a cube with a goal of rotation has colours."""
    colours = {}
    for task in ("PandaReach", "PandaPush", "PandaFlip"):
        env = ArmEnv(task, render_mode="rgb_array", render_width=240, render_height=160, render_distance=0.6)
        env.reset(seed=0)
        frame = env.render()
        assert frame is not None
        spread = frame.max(axis=2).astype(int) - frame.min(axis=2)
        colours[task] = len(np.unique((frame[spread > 60] // 64).reshape(-1, 3), axis=0))
        assert (spread > 25).sum() > 30
    assert colours["PandaFlip"] > colours["PandaPush"]


@pytest.mark.parametrize("task", ["PandaPush", "PandaSlide"])
@pytest.mark.parametrize("shape", ["box", "capsule", "cylinder", "sphere"])
def test_a_goal_has_the_shape_of_its_object_at_rest(task: str, shape: Any) -> None:
    """Seen straight from above and from far, both cover as many pixels along x and along y."""
    above: CameraOptions = {
        "eye": (0.1, 0.0, 4.0), "target": (0.1, 0.0, 0.0), "up": (1.0, 0.0, 0.0), "fov_y": 0.3, "width": 500,
        "height": 500, "look": Look(shadows=False),
    }  # fmt: skip
    env = ArmEnv(task, object_shape=shape, cameras={"above": above})
    observation, _ = env.reset(seed=1)
    picture = observation["above"].astype(int)
    green = picture[..., 1] - picture[..., 0] > 20

    def extent(place: Array) -> tuple[int, int]:
        """Of what is green about a place, along y and x."""
        pixels = 250 / (4 * math.tan(0.15))
        row, column = round(250 - (place[0] - 0.1) * pixels), round(250 - place[1] * pixels)
        near = green[row - 30 : row + 30, column - 30 : column + 30]
        return int(near.any(0).sum()), int(near.any(1).sum())

    assert extent(observation["desired_goal"]) == pytest.approx(extent(observation["achieved_goal"]), abs=2)
    assert min(extent(observation["achieved_goal"])) > 10


def test_vector_render_is_tiled() -> None:
    envs = ArmVectorEnv(5, render_mode="rgb_array", render_width=120, render_height=90)
    envs.reset(seed=7)
    tiles = envs.render()
    assert tiles.shape == (90, 120, 3)
    one = ArmEnv(render_mode="rgb_array", render_width=40, render_height=45)
    one.reset(seed=7 + 4)
    np.testing.assert_array_equal(tiles[45:, 40:80], one.render())
    assert (tiles[45:, 80:] == 0).all()
    apart = ArmVectorEnv(3, render_mode="rgb_array", render_width=40, render_height=45, render_tiles=False)
    apart.reset(seed=9)
    frames = apart.render()
    assert isinstance(frames, tuple) and len(frames) == 3
    np.testing.assert_array_equal(frames[2], one.render())
    with pytest.warns(UserWarning, match="without a render mode"):
        assert ArmVectorEnv(2).render() is None


def test_cameras_are_observed() -> None:
    cameras = {"front": {}, "wrist": {"width": 32, "height": 24, "depth": True, "segmentation": True}}
    env = gymnasium.make("PandaPickAndPlace-v3", cameras=cameras)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    assert observation["front"].shape == (84, 84, 3) and observation["front"].dtype == np.uint8
    assert observation["wrist_depth"].shape == (24, 32) and observation["wrist_segmentation"].dtype == np.int32
    after, *_ = env.step(np.array([1, 0, -1, 1], np.float32))
    assert (after["wrist"] != observation["wrist"]).any()
    assert observation["observation"].dtype == np.float32


def test_pictures_of_a_batch_are_those_of_single_environments() -> None:
    mine = mh.Camera.perspective(16, 16, 1.0).look_at([1, 0, 1], [0, 0, 0])
    cameras = {"front": {"width": 40, "height": 30}, "mine": mine}
    envs = gymnasium.make_vec("PandaPush-v3", num_envs=3, cameras=cameras, num_threads=2)
    together, _ = envs.reset(seed=5)
    assert envs.observation_space.contains(together)
    for i in range(3):
        alone, _ = gymnasium.make("PandaPush-v3", cameras=cameras).reset(seed=5 + i)
        for name in cameras:
            np.testing.assert_array_equal(together[name][i], alone[name])


def test_the_last_pictures_of_an_episode_are_kept() -> None:
    envs = ArmVectorEnv(2, max_episode_steps=2, autoreset_mode="SameStep", cameras={"front": {}})
    envs.reset(seed=0)
    actions = np.ones((2, 3), np.float32)
    envs.step(actions)
    observation, _, _, truncated, info = envs.step(actions)
    assert truncated.all()
    single = ArmEnv(cameras={"front": {}})
    single.reset(seed=1)
    single.step(actions[1])
    last, *_ = single.step(actions[1])
    np.testing.assert_array_equal(info["final_obs"][1]["front"], last["front"])
    assert (observation["front"][1] != last["front"]).any()


@pytest.mark.parametrize(
    ("cameras", "message"),
    [
        ({"observation": {}}, "another name"),
        ({"side": {}}, "needs an eye"),
        ({"front": {"zoom": 2}}, "zoom"),
        ({"front": 3}, "expected a dict"),
        ({"front": {"width": 0}}, "pixels"),
    ],
)
def test_cameras_that_cannot_be(cameras: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        ArmEnv(cameras=cameras)


def test_cameras_in_frames_that_are_not_there_are_refused_when_made() -> None:
    mounted = mh.Camera.perspective(8, 8, 0.8).look_at([0.1, 0, 0], [0, 0, 0], frame="elbow")
    for make in (ArmEnv, ArmVectorEnv):
        for camera in ({"frame": "elbow"}, mounted):
            with pytest.raises(KeyError, match=r"'front': there is no frame or link 'elbow'; there are .*panda_hand"):
                make(cameras={"front": camera})
    ArmEnv(cameras={"front": {"frame": "panda_hand"}})


def test_sizes_of_randomised_objects_are_seen() -> None:
    """The object is the last link, and from the front nothing stands before it."""
    seen = []
    for size in (0.8, 1.2):
        env = ArmEnv("PandaPush", cameras={"front": {"segmentation": True}}, randomize={"object_size": size})
        observation, _ = env.reset(seed=0)
        links = observation["front_segmentation"]
        seen.append((links == links.max()).sum())
    assert 1.5 < seen[1] / seen[0] < 3.5


def test_the_wrist_is_that_of_the_robot() -> None:
    """A camera behind the finger tips sees them, and the table beyond."""
    for robot in ("panda", "arm6"):
        env = ArmEnv("PandaPush", robot=robot, cameras={"wrist": {"segmentation": True, "depth": True}})
        observation, _ = env.reset(seed=0)
        assert len(np.unique(observation["wrist_segmentation"])) >= 2
        assert 0.1 < np.median(observation["wrist_depth"]) < 0.6


def test_what_varies_is_the_episodes_own() -> None:
    vary = {"position": 0.05, "direction": 0.1, "zoom": 0.1, "light": 0.4, "brightness": 0.3, "colour": 0.2}
    cameras = {"front": {"vary": vary}, "top": {"vary": vary}}
    envs = gymnasium.make_vec("PandaReach-v3", num_envs=3, cameras=cameras)
    first, _ = envs.reset(seed=0)
    again, _ = envs.reset(seed=0)
    alone, _ = gymnasium.make("PandaReach-v3", cameras=cameras).reset(seed=2)
    for name in cameras:
        np.testing.assert_array_equal(first[name], again[name])
        np.testing.assert_array_equal(first[name][2], alone[name])
        assert np.abs(first[name][0].astype(int) - first[name][1]).mean() > 4
    for bad in ({"postion": 0.1}, {"colour": -0.1}, {"zoom": 1.0}):
        with pytest.raises(ValueError, match="var"):
            ArmEnv(cameras={"front": {"vary": bad}})


def test_record_video_writes_what_was_rendered(tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    env = gymnasium.make("PandaReach-v3", render_mode="rgb_array", render_width=96, render_height=64)
    video = gymnasium.wrappers.RecordVideo(env, str(tmp_path), disable_logger=True)
    video.reset(seed=0)
    for _ in range(5):
        video.step(np.ones(3, np.float32))
    video.close()
    (file,) = tmp_path.glob("*.mp4")
    assert file.stat().st_size > 1000


def test_copies_see_what_the_original_sees() -> None:
    plain: CameraOptions = {"width": 24, "height": 16, "depth": True}
    camera = mh.Camera.perspective(24, 16, 0.8).look_at([0.7, 0, 0.5], [0, 0, 0])
    env = ArmEnv("PandaPush", cameras={"front": plain})
    env.reset(seed=0)
    env.step(np.ones(3))
    np.testing.assert_equal(pickle.loads(pickle.dumps(env)).observe(), env.observe())
    own: CameraOptions = {**plain, "look": Look(antialiasing=2)}
    own["vary"] = {"texture": 1.0, "textures": [mh.Texture.checker((1, 0, 0), (0, 0, 1))]}
    env = ArmEnv("PandaPush", cameras={"front": own, "mine": camera})
    env.reset(seed=1)
    np.testing.assert_equal(copy.deepcopy(env).observe(), env.observe())


def test_environments_in_a_circle_with_their_cameras_are_collected() -> None:
    """What the batch in C++ holds of Python, the collector does not see."""
    envs = ArmVectorEnv(2, cameras={"front": {"width": 8, "height": 8}})
    envs._cameras.owner = envs  # pyright: ignore[reportAttributeAccessIssue]
    seen = weakref.ref(envs)
    del envs
    gc.collect()
    assert seen() is None
