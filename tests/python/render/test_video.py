"""Videos of episodes."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from manyhands import cli
from manyhands.cli import record
from manyhands.envs.single import ArmEnv
from manyhands.video import captioned, write_video

MANYHANDS = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"


def still() -> Callable[[Any], Any]:
    """A policy that does nothing."""
    return lambda _: np.zeros(3)


def length(path: Path) -> tuple[int, float]:
    """Pictures and seconds of an MP4."""
    return imageio_ffmpeg.count_frames_and_secs(str(path))


def test_an_experts_episode_as_mp4(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "reach.mp4"
    assert cli.main(["record", "PandaReach", "--episodes", "2", "--out", str(out), "--size", "161", "120"]) == 0
    assert str(out) in capsys.readouterr().out
    frames, seconds = length(out)
    assert 2 * 9 < frames < 2 * 50  # until shortly after success, which takes a handful of steps
    assert seconds == pytest.approx(frames / 25, abs=0.1)
    reader = imageio_ffmpeg.read_frames(str(out))
    size = next(reader)["size"]
    first = np.frombuffer(next(reader), np.uint8).reshape(size[1], size[0], 3)
    assert tuple(size) == (160, 120)
    assert first.std() > 10  # not one colour


def test_an_experts_episode_as_gif(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "reach.gif"
    assert cli.main(["record", "PandaReach-v3", "--episodes", "1", "--out", str(out), "--size", "80", "60"]) == 0
    assert "manyhands: 1 episode of " in capsys.readouterr().out
    with Image.open(out) as gif:
        assert gif.size == (80, 60) and getattr(gif, "n_frames", 1) > 5


def test_a_learned_policys_episodes(reach_policy: Path, tmp_path: Path) -> None:
    """From the folder of its run or from the file in it; it reaches as it did in training."""
    out, size = tmp_path / "learned.mp4", ("--size", "80", "60")
    for policy in (reach_policy, reach_policy / "policy.onnx"):
        arguments = ["PandaReach", "--policy", str(policy), "--episodes", "4", "--hold", "0", "--out", str(out), *size]
        assert cli.main(["record", *arguments]) == 0
        frames, _ = length(out)
        # The start, at most ten steps, and eight more in which success is looked at; without success it would be 51.
        assert 4 * 9 < frames < 4 * 19
    idle = tmp_path / "idle.mp4"
    act = record.episodes(ArmEnv(render_mode="rgb_array", render_width=80, render_height=60), still, range(1), 50)
    write_video(act, idle)
    assert length(idle)[0] == 51


def test_another_robot_under_another_control(tmp_path: Path) -> None:
    out = tmp_path / "push.gif"
    asked = ["PandaReach", "--robot", "arm6", "--episodes", "1", "--out", str(out), "--size", "80", "60"]
    assert cli.main(["record", *asked]) == 0
    with Image.open(out) as gif:
        arm6 = np.asarray(gif.convert("RGB")).astype(int)
    assert cli.main(["record", *asked, "--robot", "panda", "--option", "render_yaw=45"]) == 0
    with Image.open(out) as gif:
        assert np.abs(np.asarray(gif.convert("RGB")) - arm6).max() > 100


def test_slow_motion_and_an_end_that_stands(tmp_path: Path) -> None:
    out = tmp_path / "reach.mp4"
    asked = ["record", "PandaReach", "--episodes", "1", "--out", str(out), "--size", "80", "60"]
    assert cli.main([*asked, "--hold", "0"]) == 0
    moving, seconds = length(out)
    assert cli.main([*asked, "--hold", "2", "--speed", "0.5"]) == 0
    held, slow = length(out)
    assert held == moving + 25  # 2 s of 12.5 pictures
    assert slow == pytest.approx(2 * seconds + 2, abs=0.2)


def test_captions_lie_in_the_corner() -> None:
    plain = np.full((120, 160, 3), 90, np.uint8)
    (shown,) = captioned([plain], "Reach")
    changed = (shown != plain).any(axis=2)
    assert changed[100:, :80].any() and not changed[:95].any() and not changed[:, 120:].any()
    (same,) = captioned([plain], "")
    assert np.array_equal(same, plain)


@pytest.mark.parametrize("option", [("--speed", "0"), ("--speed", "nan"), ("--hold", "-1"), ("--hold", "inf")])
def test_speeds_and_holds_that_cannot_be(option: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["record", "PandaReach", *option]) == 2
    assert f"{option[0]} is" in capsys.readouterr().err


def test_pictures_stay_in_their_order(tmp_path: Path) -> None:
    greys = [np.full((32, 32, 3), grey, np.uint8) for grey in (0, 100, 200)]
    with Image.open(write_video(greys, tmp_path / "greys.gif")) as gif:
        seen = []
        for frame in range(3):
            gif.seek(frame)
            seen.append(int(np.asarray(gif.convert("L")).mean()))
    assert seen == pytest.approx([0, 100, 200], abs=3)


@pytest.mark.parametrize("name", ["reach.mp4", "reach.gif"])
def test_what_is_interrupted_leaves_the_file_as_it_was(name: str, tmp_path: Path) -> None:
    def interrupted() -> Iterator[NDArray[np.uint8]]:
        yield np.zeros((16, 16, 3), np.uint8)
        raise KeyboardInterrupt

    out = tmp_path / name
    out.write_text("of yesterday")
    with pytest.raises(KeyboardInterrupt):
        write_video(interrupted(), out)
    assert out.read_text() == "of yesterday"
    assert list(tmp_path.iterdir()) == [out]


def on_a_small_disk(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A Python program whose files end at 4 kB, as they do where a disk is full.

    A process of its own, since the limit holds for all that a process writes, pytest's own output included.
    """
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))\n"
    return subprocess.run(
        [sys.executable, "-c", limit + program, *arguments], capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.parametrize("name", ["reach.mp4", "reach.gif"])
def test_a_full_disk_leaves_the_file_as_it_was(name: str, tmp_path: Path) -> None:
    out = tmp_path / name
    out.write_text("of yesterday")
    ended = on_a_small_disk(MANYHANDS, "record", "PandaReach", "--out", str(out), "--size", "320", "240")
    assert ended.returncode == 2
    assert ended.stdout == "" and len(ended.stderr.splitlines()) == 1
    assert out.read_text() == "of yesterday"
    assert list(tmp_path.iterdir()) == [out]


ENDLESS_NOISE = """
import sys
import numpy as np
from manyhands.video import captioned, write_video

noise = np.random.default_rng(0).integers(0, 255, (240, 320, 3)).astype(np.uint8)
made = 0

def pictures():
    global made
    for made in range(10000):
        yield np.roll(noise, made, 0)

try:
    write_video(pictures(), sys.argv[1])
except OSError as error:
    print(made, error)
"""


def test_a_long_video_ends_where_the_disk_is_full(tmp_path: Path) -> None:
    """Before all of it was made."""
    ended = on_a_small_disk(ENDLESS_NOISE, str(tmp_path / "noise.mp4"))
    made, _, error = ended.stdout.partition(" ")
    assert error.startswith("the video cannot be written: "), ended.stderr
    assert int(made) < 5000


@pytest.mark.parametrize("name", ["x.mp4", "x.gif"])
def test_a_place_that_takes_no_files_is_named(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    """Before anything is filmed, in one line, by the name that was given."""
    out = Path("/proc") / name  # which even root cannot write to
    assert cli.main(["record", "PandaReach", "--out", str(out)]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith(f"manyhands record: {out} cannot be written (")


def test_a_folder_is_no_video(tmp_path: Path) -> None:
    (tmp_path / "x.gif").mkdir()
    with pytest.raises(IsADirectoryError, match="is a folder; name a file"):
        write_video([], tmp_path / "x.gif")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_is_stopped_keeps_the_episodes_that_were_filmed(number: signal.Signals, tmp_path: Path) -> None:
    out = tmp_path / "long.mp4"
    asked = ["PandaReach", "--episodes", "100000", "--out", str(out), "--size", "80", "60"]
    process = subprocess.Popen(
        [sys.executable, "-c", MANYHANDS, "record", *asked], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    deadline = time.monotonic() + 60
    while not any(path.stat().st_size for path in tmp_path.iterdir()):
        assert time.monotonic() < deadline and process.poll() is None, process.communicate()
        time.sleep(0.05)
    os.killpg(process.pid, number)  # as a terminal does, to all that the command started
    said, err = process.communicate(timeout=60)
    assert process.returncode == 130 and not err
    assert list(tmp_path.iterdir()) == [out]
    found = re.fullmatch(r"manyhands: stopped; (\d+) of 100000 episodes of PandaReach.* in (.*)\n", said)
    assert found and found[2] == str(out)
    episodes = int(found[1])
    assert 9 * episodes < length(out)[0] < 51 * episodes


def test_nonsense_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, text in (
        (["PandaReach", "--out", str(tmp_path / "a.avi")], ".mp4 or .gif"),
        (["PandaReach", "--out", str(tmp_path / "nodir/x.mp4")], "there is no folder"),
        (["PandaReach", "--out", str(tmp_path / "nodir/x.gif")], "there is no folder"),
        (["PandaReach", "--episodes", "0"], "--episodes"),
        (["PandaNothing"], "no environment"),
        (["PandaReach", "--policy", str(tmp_path / "none.onnx")], "there is no file"),
        (["PandaReach", "--control", "ee_pose"], "give a --policy"),
        (["PandaReach", "--control", "mind"], "expected one of ['ee', 'joints'"),
        (["PandaReach", "--robot", "ur5"], "expected 'panda', 'arm6'"),
        (["PandaReach", "--option", "task=PandaPush"], "task is no option"),
    ):
        assert cli.main(["record", *arguments]) == 2
        assert text in capsys.readouterr().err
    with pytest.raises(ValueError, match="no pictures"):
        write_video([], tmp_path / "empty.mp4")
