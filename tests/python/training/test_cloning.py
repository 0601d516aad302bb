"""Cloned policies do what was demonstrated; their files are the policies; bad datasets are told in one line."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from manyhands import cli
from manyhands._core.envs import make_env_batch
from manyhands.demos.episodes import Demonstrations
from manyhands.training.cloning import ClonedPolicy, CloningSettings, chunks, clone
from manyhands.training.evaluation import PolicyFile
from manyhands.training.policy_file import save_policy

pytest.importorskip("h5py", reason="h5py is not installed: make test installs it")
pytest.importorskip("pyarrow", reason="pyarrow is not installed: make test installs it")

NAMES = {"minari": "expert-v0", "lerobot": "folder", "npz": "file.npz"}
SPEC = make_env_batch("PandaReach-v3", 1).spec
QUICK = CloningSettings(steps=300, hidden_layers=(32, 24))


def some_demonstrations(seed: int = 0) -> Demonstrations:
    """Of the law a = tanh(goal - position), whatever else is seen."""
    rng = np.random.default_rng(seed)
    lengths = np.array([3, 1, 5] * 40)
    n = int(lengths.sum())
    observation, desired = (rng.normal(size=(n, k)).astype(np.float32) for k in (6, 3))
    achieved = observation[:, :3]
    return Demonstrations("PandaReach-v3", observation, achieved, desired, np.tanh(desired - achieved), lengths)


def test_chunks_end_with_their_episodes() -> None:
    actions = np.arange(12, dtype=np.float32).reshape(6, 2)
    found = chunks(actions, np.array([4, 2]), 3).reshape(6, 3, 2)
    none = [np.nan, np.nan]
    expected = [
        [[0, 1], [2, 3], [4, 5]],
        [[2, 3], [4, 5], [6, 7]],
        [[4, 5], [6, 7], none],
        [[6, 7], none, none],
        [[8, 9], [10, 11], none],
        [[10, 11], none, none],
    ]
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(chunks(actions, np.array([4, 2]), 1), actions)


def test_the_law_behind_demonstrations_is_found() -> None:
    losses = []
    clone(some_demonstrations(), SPEC, CloningSettings(steps=3000), 1, lambda step, loss: losses.append(loss))
    assert losses[0] > 0.02
    assert losses[-1] < 1e-3  # the actions' own variance is 0.6


def test_threads_do_not_show_in_the_policy() -> None:
    one, two = (clone(some_demonstrations(), SPEC, QUICK, threads) for threads in (1, 2))
    for (weight, bias), (other_weight, other_bias) in zip(one.layers, two.layers, strict=True):
        np.testing.assert_array_equal(weight, other_weight)
        np.testing.assert_array_equal(bias, other_bias)


def by_hand(policy: ClonedPolicy, seen: dict[str, np.ndarray]) -> np.ndarray:
    goals = [seen["desired_goal"], seen["desired_goal"] - seen["achieved_goal"]]
    x = np.hstack([seen["observation"], *goals]).astype(float)
    x = np.clip((x - policy.mean) * policy.scale, -policy.clip, policy.clip)
    for i, (weight, bias) in enumerate(policy.layers):
        x = x @ weight.T.astype(float) + bias
        x = np.tanh(x) if i == len(policy.layers) - 1 else np.maximum(x, 0)
    return x.reshape(len(x), policy.chunk, policy.action_dim)


@pytest.mark.parametrize("chunk", [1, 4])
def test_the_file_is_the_policy(chunk: int, tmp_path: Path) -> None:
    import onnxruntime

    settings = CloningSettings(chunk=chunk, steps=300, hidden_layers=(32, 24))
    policy = clone(some_demonstrations(), SPEC, settings, 1)
    save_policy(policy, "PandaReach-v3", tmp_path / "policy.onnx")
    rng = np.random.default_rng(1)
    sizes = {"observation": 6, "achieved_goal": 3, "desired_goal": 3}
    seen = {name: rng.normal(scale=2, size=(20, size)).astype(np.float32) for name, size in sizes.items()}
    expected = by_hand(policy, seen)
    (found,) = onnxruntime.InferenceSession(tmp_path / "policy.onnx").run(None, seen)
    assert found.shape == ((20, 3) if chunk == 1 else (20, 4, 3))
    np.testing.assert_allclose(found.reshape(expected.shape), expected, atol=1e-5)
    file = PolicyFile(tmp_path / "policy.onnx")
    file.require_fit(SPEC)
    np.testing.assert_allclose(file(seen), expected[:, 0], atol=1e-5)
    np.testing.assert_allclose(file({name: rows[5] for name, rows in seen.items()}), expected[5, 0], atol=1e-5)


@pytest.fixture(scope="module")
def datasets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """200 episodes of Reach in each format."""
    folder = tmp_path_factory.mktemp("datasets")
    for format, name in NAMES.items():
        arguments = ["demos", "PandaReach", "-n", "200", "--format", format, "--out", str(folder / name)]
        assert cli.main(arguments) == 0
    return folder


@pytest.mark.parametrize(("format", "chunk"), [("minari", "1"), ("lerobot", "3"), ("npz", "1")])
def test_reach_is_cloned(
    format: str, chunk: str, datasets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "policy.onnx"
    arguments = [str(datasets / NAMES[format]), "--chunk", chunk, "--out", str(out), "--steps", "3000"]
    assert cli.main(["clone", *arguments, "--hidden", "64", "64", "--episodes", "200"]) == 0
    assert "has learned from 200 episodes" in capsys.readouterr().out
    assert cli.main(["evaluate", str(out), "--episodes", "200", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["success_rate"] >= 0.98


def broken(format: str, datasets: Path, path: Path) -> Path:
    """A copy whose largest file has lost its second half."""
    given = datasets / NAMES[format]
    copy = path / given.name
    shutil.copytree(given, copy) if given.is_dir() else shutil.copy(given, copy)
    files = [copy] if copy.is_file() else [file for file in copy.rglob("*") if file.suffix in (".hdf5", ".parquet")]
    largest = max(files, key=lambda file: file.stat().st_size)
    if format == "lerobot":
        (largest,) = copy.glob("data/*/*.parquet")
    data = largest.read_bytes()
    largest.write_bytes(data[: len(data) // 2])
    return copy


@pytest.mark.parametrize("format", NAMES)
def test_a_dataset_that_is_cut_off_is_told(
    format: str, datasets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = broken(format, datasets, tmp_path)
    assert cli.main(["clone", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert str(path) in line


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"observation": np.zeros((4, 18), np.float32)}, "its observation has shape (4, 18), expected (4, 6)"),
        ({"action": np.zeros((4, 4), np.float32)}, "its action has shape (4, 4), expected (4, 3)"),
        ({"lengths": np.array([2, 3])}, "has shape (4, 6), expected (5, 6)"),
        ({"lengths": np.array([4, 0])}, "an episode without steps"),
        ({"lengths": np.array([], np.int64)}, "no episodes"),
        ({"action": np.full((4, 3), np.nan, np.float32)}, "its action holds what is no finite number"),
    ],
)
def test_demonstrations_that_do_not_fit_are_refused(change: dict[str, np.ndarray], message: str) -> None:
    arrays = {"observation": 6, "achieved_goal": 3, "desired_goal": 3, "action": 3}
    given = {name: np.zeros((4, size), np.float32) for name, size in arrays.items()}
    given |= {"lengths": np.array([2, 2])} | change
    with pytest.raises(ValueError) as caught:
        Demonstrations("PandaReach-v3", **given).checked("set", SPEC)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nowhere"], "there are no demonstrations nowhere"),
        (["{npz}", "--env", "PandaPush"], "does not fit PandaPush-v3: its observation has shape"),
        (["{npz}", "--env", "PandaPish"], "did you mean PandaPush-v3"),
        (["{npz}", "--chunk", "0"], "--chunk is 0"),
        (["{npz}", "--steps", "0"], "--steps is 0"),
        (["{npz}", "--batch-size", "3"], "batch_size is 3"),
        (["{npz}", "--batch-size", "99999999999"], "--batch-size is 99999999999"),
        (["{npz}", "--threads", "0"], "--threads is 0, expected 1 to 1024"),
        (["{npz}", "--learning-rate", "-1"], "learning_rate must be positive"),
        (["{npz}", "--learning-rate", "1e30"], "diverged"),
        (["{npz}", "--out", "/nowhere/x.onnx", "--steps", "1000000000"], "there is no folder /nowhere"),
        (["."], "holds no demonstrations"),
    ],
)
def test_bad_requests_are_explained(
    arguments: list[str],
    message: str,
    datasets: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    given = [one.format(npz=datasets / NAMES["npz"]) for one in arguments]
    assert cli.main(["clone", *given]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert not list(tmp_path.iterdir())
