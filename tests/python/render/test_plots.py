"""Recordings of runs, and their pictures."""

import json
import re
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from PIL import Image

import manyhands as mh
from manyhands.envs import ArmEnv
from manyhands.panda_gym.envs.panda_tasks import PandaPushEnv
from manyhands.plots import panels, plot
from manyhands.recording import Recorder, Recording


@pytest.fixture(scope="module")
def run() -> Recording:
    """An arm that is let go while a cube falls on the floor."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.add_plane("floor")
    world.add_box("cube", [0.03, 0.03, 0.03], mass=0.2, position=[1.5, 0, 0.05])
    recorder = Recorder(world)
    for _ in range(200):
        world.step(2)
        recorder.add(reward=-world.body_pose("cube")[0][2])
    return recorder.recording()


def test_a_recording_is_what_happened(run: Recording) -> None:
    assert len(run.time) == 200 and run.time[-1] == pytest.approx(0.8)
    assert run.positions.shape == run.velocities.shape == run.forces.shape == (200, 9)
    # Velocities are the rates of the positions, by differences of 4 ms, but where a joint hits its limit.
    rates = np.diff(run.positions, axis=0) / 0.004
    assert np.quantile(np.abs(rates - (run.velocities[1:] + run.velocities[:-1]) / 2), 0.9) < 0.02
    assert run.contacts[-1, run.touched.index("cube")] == pytest.approx(0.2 * 9.81, rel=1e-3)
    assert run.rewards[-1] == pytest.approx(-0.03, abs=1e-4)


def test_files_keep_recordings(run: Recording, tmp_path: Path) -> None:
    path = run.save(tmp_path / "run")  # gets its ending
    assert path == tmp_path / "run.npz"
    again = Recording.load(path)
    assert again.joints == run.joints and again.touched == run.touched
    assert np.array_equal(again.positions, run.positions) and np.array_equal(again.contacts, run.contacts)
    np.savez(tmp_path / "other.npz", a=1)
    with pytest.raises(ValueError, match="no recording"):
        Recording.load(tmp_path / "other.npz")


def test_one_call_draws_a_picture(run: Recording, tmp_path: Path) -> None:
    assert [panel.title for panel in panels(run)] == [
        "Joint positions", "Joint velocities", "Joint forces", "Contact forces", "Hand", "Reward",
    ]  # fmt: skip
    picture = np.asarray(Image.open(plot(run.save(tmp_path / "run.npz"), tmp_path / "run.png")).convert("RGB"))
    assert picture.shape[1] > 1000 and len(np.unique(picture.reshape(-1, 3), axis=0)) > 100


def test_one_call_draws_a_page_that_opens_alone(run: Recording, tmp_path: Path) -> None:
    text = plot(run, tmp_path / "run.html").read_text()
    assert "panda_joint4" in text and "Contact forces" in text
    assert '<script src="http' not in text


def test_a_joint_has_one_colour_and_one_line_in_the_legend(run: Recording, tmp_path: Path) -> None:
    text = plot(run, tmp_path / "run.html").read_text()
    lines, _ = json.JSONDecoder().raw_decode(text[re.search(r'\[\{"legendgroup"|\[\{"line"', text).start() :])  # pyright: ignore[reportOptionalMemberAccess]
    joint = [line for line in lines if line["name"] == "panda_joint4"]
    assert len(joint) == 3 and len({line["line"]["color"] for line in joint}) == 1
    assert [line["showlegend"] for line in joint] == [True, False, False]
    first = [line["line"]["color"] for line in lines if line["xaxis"] == "x"]
    assert len(first) == len(set(first)) == 9


def test_a_world_without_joints_leaves_no_panel_empty(tmp_path: Path) -> None:
    world = mh.World()
    world.add_plane("floor")
    world.add_box("cube", [0.03, 0.03, 0.03], mass=0.2, position=[0, 0, 0.05])
    recorder = Recorder(world)
    for _ in range(100):
        world.step(2)
        recorder.add()
    run = recorder.recording()
    drawn = panels(run)
    picture = np.asarray(Image.open(plot(run, tmp_path / "run.png")).convert("L"))
    assert len(drawn) % 2 == 1  # one that stands alone fills its row
    assert (picture[:, -picture.shape[1] // 8 :] < 250).any()


def test_other_endings_are_refused(run: Recording, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected"):
        plot(run, tmp_path / "run.pdf")


def test_nothing_recorded_is_said() -> None:
    with pytest.raises(RuntimeError, match="call add"):
        Recorder(mh.World()).recording()


def test_what_is_no_recording_is_said(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text("<robot/>")
    np.save(tmp_path / "numbers.npy", np.zeros(3))
    for name in ("robot.urdf", "numbers.npy"):
        with pytest.raises(ValueError, match=f"{name} is no recording"):
            plot(tmp_path / name, tmp_path / "run.png")
    with pytest.raises(FileNotFoundError):
        plot(tmp_path / "nothing.npz", tmp_path / "run.png")


def test_environments_of_the_drop_in_are_recorded() -> None:
    env = gymnasium.wrappers.TimeLimit(PandaPushEnv(), 50)
    env.reset(seed=0)
    recorder = Recorder(env)
    for _ in range(3):
        _, reward, *_ = env.step(np.array([0.5, 0, 0], np.float32))
        recorder.add(float(reward))
    run = recorder.recording()
    np.testing.assert_allclose(np.diff(run.time), 0.04)
    angles = [env.unwrapped.robot.get_joint_angle(joint) for joint in range(7)]  # pyright: ignore[reportAttributeAccessIssue]
    np.testing.assert_array_equal(run.positions[-1, :7], angles)
    np.testing.assert_array_equal(run.rewards, [-1, -1, -1])
    assert run.hand.shape == (3, 3)


def test_what_cannot_be_recorded_is_said() -> None:
    for other in (ArmEnv(), 3, None):
        with pytest.raises(TypeError, match=f"a {type(other).__name__} cannot be recorded: expected a manyhands.World"):
            Recorder(other)


def test_modules_come_when_they_are_asked_for() -> None:
    code = """
import sys, manyhands as mh
assert not {"manyhands.plots", "manyhands.recording", "manyhands.video"} & set(sys.modules)
mh.plots.plot, mh.recording.Recorder, mh.video.write_video
try:
    mh.nothing
except AttributeError as error:
    assert "manyhands" in str(error) and "nothing" in str(error)
else:
    raise SystemExit("mh.nothing is something")
"""
    subprocess.run([sys.executable, "-c", code], check=True)
