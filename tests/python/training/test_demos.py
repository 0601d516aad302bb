"""Demonstrations are what the environment does under their actions, and datasets of them hold just that."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from manyhands import cli
from manyhands.cli.demos import _env_spec
from manyhands.cli.named_env import NamedEnv
from manyhands.demos.collect import collect
from manyhands.demos.episodes import Episode, Source
from manyhands.demos.formats import FORMATS, read, write
from manyhands.demos.statistics import histogram, of_histogram, of_rows
from manyhands.envs.registration import make_vector_env
from manyhands.envs.single import ArmEnv
from manyhands.experts import Expert
from manyhands.files import replacing_folder

pytest.importorskip("h5py", reason="h5py is not installed: make test installs it")
pytest.importorskip("pyarrow", reason="pyarrow is not installed: make test installs it")

CAMERAS = {"front": {"width": 40, "height": 32}}
NAMES = {"minari": "expert-v0", "lerobot": "folder", "npz": "file.npz"}


def episodes(wanted: int = 5, worlds: int = 3, noise: float = 0.0, **options: Any) -> list[Episode]:
    env = make_vector_env("PandaPush-v3", worlds, **options)
    return list(collect(env, lambda: Expert("PandaPush-v3"), wanted, 7, noise))


def source(cameras: dict[str, tuple[int, int]] | None = None) -> Source:
    named = NamedEnv("PandaPush-v3")
    return Source("PandaPush-v3", _env_spec(named), named.spec(), "expert", 0.0, 7, cameras or {})


@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_episodes_are_what_the_environment_does(noise: float) -> None:
    env = ArmEnv("PandaPush")
    for number, episode in enumerate(episodes(noise=noise)):
        assert episode.seed == 7 + number
        observation, _ = env.reset(seed=episode.seed)
        for t, action in enumerate(episode.actions):
            for name, rows in episode.observations.items():
                np.testing.assert_array_equal(rows[t], observation[name])
            observation, reward, terminated, _, info = env.step(action)
            assert (reward, info["is_success"]) == (episode.rewards[t], episode.success[t])
            assert terminated == (episode.terminated and t == len(episode) - 1)
        np.testing.assert_array_equal(episode.observations["observation"][-1], observation["observation"])
        assert len(episode.observations["observation"]) == len(episode) + 1


def test_episodes_do_not_depend_on_the_worlds_they_ran_in() -> None:
    for noise in (0.0, 0.2):
        for one, other in zip(episodes(5, 2, noise), episodes(5, 7, noise), strict=True):
            np.testing.assert_array_equal(one.actions, other.actions)
            np.testing.assert_array_equal(one.observations["observation"], other.observations["observation"])


def test_noise_is_added_to_what_was_intended() -> None:
    clean, noisy = episodes(20)[0], episodes(40, 8, 0.2)
    np.testing.assert_array_equal(clean.actions, clean.intended)
    added = np.concatenate([one.actions - one.intended for one in noisy])
    free = np.concatenate([np.abs(one.actions) < 1 for one in noisy])  # the rest is cut off
    inside = np.concatenate([np.abs(one.intended) < 0.3 for one in noisy]) & free
    # 500 and more draws: the deviation is known to 4 %, 10 % is beyond three times that... of a normal law
    assert inside.sum() > 500
    assert np.std(added[inside]) == pytest.approx(0.2, rel=0.1)
    assert all(np.abs(one.actions).max() <= 1 for one in noisy)


def test_failures_can_be_left_out() -> None:
    expert = Expert("PandaPush-v3")
    every_second = np.tile([1, 0], 8)[:, None].astype(np.float32)
    env = make_vector_env("PandaPush-v3", 16)
    some = list(collect(env, lambda: lambda seen: every_second * expert(seen), 12, 0, success_only=True))
    assert [one.seed for one in some] == list(range(0, 24, 2))
    assert all(one.succeeded for one in some)
    env = make_vector_env("PandaPickAndPlace-v3", 16)
    with pytest.raises(ValueError, match="of 40 episodes only"):
        list(collect(env, lambda: lambda seen: np.ones((16, 4), np.float32), 2, 0, success_only=True))


@pytest.mark.parametrize("format", FORMATS)
def test_what_is_written_is_read_again(format: str, tmp_path: Path) -> None:
    found, path = episodes(noise=0.1), tmp_path / NAMES[format]
    write(format, found, source(), path)
    shown = read(path)
    assert shown.env_id == "PandaPush-v3"
    assert shown.lengths.tolist() == [len(one) for one in found]
    np.testing.assert_array_equal(shown.action, np.concatenate([one.intended for one in found]))
    for name in ("observation", "achieved_goal", "desired_goal"):
        expected = np.concatenate([one.observations[name][:-1] for one in found])
        np.testing.assert_array_equal(getattr(shown, name), expected)
    shown.checked(path, source().spec)


def struck(found: list[Episode]) -> Iterator[Episode]:
    yield from found[:2]
    raise KeyboardInterrupt


@pytest.mark.parametrize("format", FORMATS)
def test_a_dataset_is_whole_or_not_there(format: str, tmp_path: Path) -> None:
    found, path = episodes(cameras=CAMERAS), tmp_path / NAMES[format]
    with pytest.raises(KeyboardInterrupt):
        write(format, struck(found), source({"front": (32, 40)}), path)
    assert not list(tmp_path.iterdir())
    write(format, found[:3], source({"front": (32, 40)}), path)
    before = len(read(path).lengths)
    with pytest.raises(FileExistsError, match="--force"):
        write(format, found, source({"front": (32, 40)}), path)
    with pytest.raises(KeyboardInterrupt):
        write(format, struck(found), source({"front": (32, 40)}), path, force=True)
    assert len(read(path).lengths) == before == 3
    write(format, found, source({"front": (32, 40)}), path, force=True)
    assert len(read(path).lengths) == 5
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


def test_a_folder_is_replaced_whole(tmp_path: Path) -> None:
    place = tmp_path / "there" / "folder"
    with replacing_folder(place, "mark") as folder:
        (folder / "mark").touch()
        (folder / "old").touch()
    with replacing_folder(place, "mark", force=True) as folder:
        (folder / "new").touch()
        assert (place / "old").exists()
    assert [one.name for one in place.iterdir()] == ["new"]
    assert [one.name for one in place.parent.iterdir()] == ["folder"]


@pytest.mark.parametrize("format", ["minari", "lerobot"])
def test_force_replaces_datasets_only(format: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = tmp_path / "home-v0"
    home.mkdir()
    (home / "letter").touch()
    (tmp_path / "file-v0").touch()
    monkeypatch.chdir(home)
    for path in (home, Path(), Path("..", "file-v0")):
        with pytest.raises(FileExistsError, match="is no dataset"):
            write(format, episodes(1), source(), path, force=True)
    assert (home / "letter").exists()


@pytest.mark.parametrize("format", FORMATS)
def test_a_full_disk_is_told_in_one_line(format: str, tmp_path: Path) -> None:
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (20000, resource.RLIM_INFINITY))\n"
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    path = tmp_path / NAMES[format]
    command = ["demos", "PandaPush", "-n", "40", "--format", format, "--out", str(path)]
    process = subprocess.run([sys.executable, "-c", limit + program, *command], capture_output=True, text=True)
    assert process.returncode == 2, process.stderr
    (line,) = process.stderr.splitlines()
    assert line.startswith("manyhands demos: ")
    assert not list(tmp_path.iterdir())


def test_statistics_are_those_of_numpy() -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(size=(51, 2))
    rows = of_rows(values)
    assert rows["count"] == [51]
    assert rows["q50"] == np.median(values, axis=0).tolist()
    pictures = rng.integers(0, 256, (3, 8, 9, 3), np.uint8)
    pictures[..., 1] //= 2
    found = of_histogram(histogram(pictures), 3)
    scaled = pictures.reshape(-1, 3) / 255
    for name, expected in (("min", scaled.min(0)), ("max", scaled.max(0)), ("mean", scaled.mean(0))):
        np.testing.assert_allclose(np.ravel(found[name]), expected)
    np.testing.assert_allclose(np.ravel(found["std"]), scaled.std(0))
    for share in (1, 10, 50, 90, 99):
        expected = np.quantile(scaled, share / 100, axis=0, method="inverted_cdf")
        np.testing.assert_allclose(np.ravel(found[f"q{share:02d}"]), expected)
    assert found["count"] == [3]


def test_the_command_makes_the_same_dataset_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = []
    for name, threads in (("one.npz", "1"), ("two.npz", "2")):
        path = tmp_path / name
        arguments = ["PandaReach", "-n", "30", "--seed", "3", "--noise", "0.1", "--format", "npz", "--out", str(path)]
        assert cli.main(["demos", *arguments, "--threads", threads]) == 0
        assert "30 episodes are in" in capsys.readouterr().out
        shown.append(np.load(path))
    for name in shown[0].files:
        np.testing.assert_array_equal(shown[0][name], shown[1][name])


def test_a_policy_demonstrates_too(reach_policy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "reach.npz"
    arguments = ["PandaReach", "-n", "20", "--out", str(path), "--policy", str(reach_policy)]  # .npz says what it is
    assert cli.main(["demos", *arguments]) == 0
    assert "success 100.0%" in capsys.readouterr().out
    assert str(np.load(path)["policy"]) == reach_policy.name


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["PandaReech"], "did you mean PandaReach-v3"),
        (["PandaReachJoints"], "moves the hand by control 'ee'"),
        (["PandaReach", "-n", "0"], "--episodes is 0"),
        (["PandaReach", "--seed", "-1"], "--seed is -1"),
        (["PandaReach", "--noise", "nan"], "--noise is nan"),
        (["PandaReach", "--cameras", "back"], "back"),
        (["PandaReach", "--policy", "nowhere.onnx"], "there is no file nowhere.onnx"),
        (["PandaReach", "--out", "plain"], "end it with a version"),
        (["PandaReach", "--out", "/proc/x/expert-v0"], "cannot be written"),
        (["PandaReach", "--format", "npz", "--out", "/nowhere/x.npz"], "there is no folder /nowhere"),
        (["PandaReach", "--format", "npz", "--out", ".", "--force"], "is a folder; name a file"),
        (["PandaReach", "--format", "lerobot", "--option", "n_substeps=17"], "whole number of frames"),
    ],
)
def test_bad_requests_are_explained_and_leave_nothing(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["demos", *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert not [name for _, _, files in os.walk(tmp_path) for name in files]


def test_lerobots_numbers_of_episodes_and_frames_are_right(tmp_path: Path) -> None:
    found = episodes()
    write("lerobot", found, source(), tmp_path / "set")
    info = json.loads((tmp_path / "set/meta/info.json").read_text())
    assert (info["total_episodes"], info["total_frames"], info["fps"]) == (5, sum(map(len, found)), 25)
    assert info["splits"] == {"train": "0:5"}
