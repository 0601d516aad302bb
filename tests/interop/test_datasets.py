"""Minari and LeRobot read the demonstrations that we write, number for number, and we read theirs."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from manyhands.cli.demos import _env_spec
from manyhands.cli.named_env import NamedEnv
from manyhands.demos.collect import collect
from manyhands.demos.episodes import Episode, Source
from manyhands.demos.formats import read, write
from manyhands.envs.vector import ArmVectorEnv
from manyhands.experts import Expert

SIZE = (32, 40)
NAMES = ("observation", "achieved_goal", "desired_goal", "front")


@pytest.fixture(scope="module")
def named() -> NamedEnv:
    return NamedEnv("PandaPush-v3", {"cameras": {"front": {"width": SIZE[1], "height": SIZE[0]}}})


@pytest.fixture(scope="module")
def source(named: NamedEnv) -> Source:
    return Source(named.id, _env_spec(named), named.spec(), "expert", 0.1, 3, {"front": SIZE})


@pytest.fixture(scope="module")
def episodes(named: NamedEnv) -> list[Episode]:
    env = ArmVectorEnv(4, **named.variant)
    return list(collect(env, lambda: Expert(named.id), 6, 3, 0.1))


def test_minari_reads_what_we_write(
    episodes: list[Episode], source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    minari = pytest.importorskip("minari")
    write("minari", episodes, source, tmp_path / "PandaPush" / "expert-v0")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    assert list(minari.list_local_datasets()) == ["PandaPush/expert-v0"]
    dataset = minari.load_dataset("PandaPush/expert-v0")
    assert (dataset.id, len(dataset), dataset.total_steps) == ("PandaPush/expert-v0", 6, sum(map(len, episodes)))
    metadata = dataset.storage.get_episode_metadata(range(6))
    for ours, theirs, about in zip(episodes, dataset.iterate_episodes(), metadata, strict=True):
        assert (about["seed"], about["total_steps"]) == (ours.seed, len(ours))
        for name in NAMES:
            np.testing.assert_array_equal(theirs.observations[name], ours.observations[name])
        np.testing.assert_array_equal(theirs.actions, ours.actions)
        np.testing.assert_array_equal(theirs.rewards, ours.rewards)
        np.testing.assert_array_equal(theirs.infos["is_success"], ours.success)
        np.testing.assert_array_equal(theirs.infos["intended_action"], ours.intended)
        assert theirs.terminations.sum() == theirs.terminations[-1] == ours.terminated
        assert theirs.truncations.sum() == theirs.truncations[-1] == (not ours.terminated)
        assert dataset.observation_space.contains({name: ours.observations[name][0] for name in NAMES})
        assert dataset.action_space.contains(ours.actions[0])
    seen, _ = dataset.recover_environment().reset(seed=episodes[0].seed)
    for name in NAMES:
        np.testing.assert_array_equal(seen[name], episodes[0].observations[name][0])


def test_we_read_what_minari_writes(
    episodes: list[Episode], source: Source, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    minari = pytest.importorskip("minari")
    from minari.data_collector.episode_buffer import EpisodeBuffer

    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    buffers = []
    for ours in episodes:
        ends = np.arange(len(ours)) == len(ours) - 1
        rows = {name: ours.observations[name] for name in NAMES[:3]}
        flags = {"terminations": ends & ours.terminated, "truncations": ends & (not ours.terminated)}
        buffers.append(EpisodeBuffer(observations=rows, actions=ours.actions, rewards=ours.rewards, infos={}, **flags))
    minari.create_dataset_from_buffers("theirs-v0", buffers, env="PandaPush-v3")
    shown = read(tmp_path / "theirs-v0").checked("theirs-v0", source.spec)
    assert shown.env_id == "PandaPush-v3"
    np.testing.assert_array_equal(shown.action, np.concatenate([ours.actions for ours in episodes]))
    np.testing.assert_array_equal(
        shown.observation, np.concatenate([ours.observations["observation"][:-1] for ours in episodes])
    )


@pytest.fixture(scope="module")
def lerobot() -> Any:
    return pytest.importorskip("lerobot.datasets.lerobot_dataset")


def test_lerobot_reads_what_we_write(lerobot: Any, episodes: list[Episode], source: Source, tmp_path: Path) -> None:
    write("lerobot", episodes, source, tmp_path / "push")
    windows = {"action": [0.0, 0.04, 0.08]}
    dataset = lerobot.LeRobotDataset("manyhands/push", root=tmp_path / "push", delta_timestamps=windows)
    assert (dataset.num_episodes, dataset.num_frames, dataset.fps) == (6, sum(map(len, episodes)), 25)
    assert dataset.meta.camera_keys == ["observation.images.front"]
    index = 0
    for number, ours in enumerate(episodes):
        seen = ours.observations
        for t in range(len(ours)):
            frame = dataset[index]
            np.testing.assert_array_equal(frame["observation.state"], seen["observation"][t])
            goals = np.concatenate([seen["achieved_goal"][t], seen["desired_goal"][t]])
            np.testing.assert_array_equal(frame["observation.environment_state"], goals)
            pixels = np.rint(frame["observation.images.front"].numpy() * 255).astype(np.uint8)
            np.testing.assert_array_equal(pixels.transpose(1, 2, 0), seen["front"][t])
            for ahead in range(3):
                inside = t + ahead < len(ours)
                assert frame["action_is_pad"][ahead] == (not inside)
                if inside:
                    np.testing.assert_array_equal(frame["action"][ahead], ours.actions[t + ahead])
            np.testing.assert_array_equal(frame["intended_action"], ours.intended[t])
            assert frame["next.reward"] == ours.rewards[t]
            assert frame["next.success"] == ours.success[t]
            assert frame["next.done"] == (t == len(ours) - 1)
            assert (frame["index"], frame["episode_index"], frame["frame_index"]) == (index, number, t)
            assert frame["timestamp"] == np.float32(t / 25)
            assert frame["task"] == "Push the cube to the target."
            index += 1


def test_some_episodes_of_ours_can_be_chosen(
    lerobot: Any, episodes: list[Episode], source: Source, tmp_path: Path
) -> None:
    write("lerobot", episodes, source, tmp_path / "push")
    dataset = lerobot.LeRobotDataset("manyhands/push", root=tmp_path / "push", episodes=[1, 4])
    assert dataset.num_frames == len(episodes[1]) + len(episodes[4])


def test_statistics_are_those_of_lerobot(lerobot: Any, episodes: list[Episode], source: Source, tmp_path: Path) -> None:
    """Sums are; LeRobot's quantiles come from histograms of its own and are not compared."""
    from lerobot.datasets.compute_stats import compute_episode_stats

    write("lerobot", episodes, source, tmp_path / "push")
    meta = lerobot.LeRobotDatasetMetadata("manyhands/push", root=tmp_path / "push")
    action = np.concatenate([ours.actions for ours in episodes])
    state = np.concatenate([ours.observations["observation"][:-1] for ours in episodes])
    features = {name: meta.features[name] for name in ("action", "observation.state")}
    theirs = compute_episode_stats({"action": action, "observation.state": state}, features)
    for name, expected in theirs.items():
        for key in ("min", "max", "mean", "std", "count"):
            np.testing.assert_allclose(meta.stats[name][key], expected[key], rtol=1e-4, atol=1e-6, err_msg=name)
    pictures = np.concatenate([ours.observations["front"][:-1] for ours in episodes]).reshape(-1, 3) / 255
    found = meta.stats["observation.images.front"]
    np.testing.assert_allclose(found["mean"].ravel(), pictures.mean(0))
    np.testing.assert_allclose(found["std"].ravel(), pictures.std(0))
    assert found["mean"].shape == (3, 1, 1)


def test_datasets_of_ours_can_be_put_together_by_lerobot(
    lerobot: Any, episodes: list[Episode], source: Source, tmp_path: Path
) -> None:
    """Which reads the episodes' own statistics."""
    from lerobot.datasets.aggregate import aggregate_datasets

    for name, some in (("one", episodes[:2]), ("two", episodes[2:])):
        write("lerobot", some, source, tmp_path / name)
    roots = [tmp_path / "one", tmp_path / "two"]
    aggregate_datasets(["a/one", "a/two"], "a/both", roots=roots, aggr_root=tmp_path / "both")
    both = lerobot.LeRobotDataset("a/both", root=tmp_path / "both")
    assert (both.num_episodes, both.num_frames) == (6, sum(map(len, episodes)))
    np.testing.assert_array_equal(both[len(episodes[0])]["action"], episodes[1].actions[0])


def test_we_read_what_lerobot_writes(lerobot: Any, episodes: list[Episode], source: Source, tmp_path: Path) -> None:
    def feature(size: int) -> dict[str, Any]:
        return {"dtype": "float32", "shape": (size,), "names": None}

    features = {"observation.state": feature(18), "observation.environment_state": feature(6), "action": feature(3)}
    theirs = lerobot.LeRobotDataset.create("a/theirs", 25, features, root=tmp_path / "theirs", use_videos=False)
    for ours in episodes[:3]:
        seen = ours.observations
        for t in range(len(ours)):
            goals = np.concatenate([seen["achieved_goal"][t], seen["desired_goal"][t]])
            rows = {"observation.state": seen["observation"][t], "observation.environment_state": goals}
            theirs.add_frame({**rows, "action": ours.actions[t], "task": "push"})
        theirs.save_episode()
    theirs.finalize()
    shown = read(tmp_path / "theirs").checked("theirs", source.spec)
    assert shown.env_id is None
    assert shown.lengths.tolist() == [len(ours) for ours in episodes[:3]]
    np.testing.assert_array_equal(shown.action, np.concatenate([ours.actions for ours in episodes[:3]]))
    np.testing.assert_array_equal(
        shown.desired_goal, np.concatenate([ours.observations["desired_goal"][:-1] for ours in episodes[:3]])
    )
