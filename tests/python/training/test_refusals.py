"""What cannot be done is told in one line, by every command alike, and leaves everything as it was."""

import random
import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest

from manyhands import cli
from manyhands._core.envs import make_env_batch
from manyhands._core.learn import CheckpointError, read_policy
from manyhands.demos.formats import read
from manyhands.training.evaluation import PolicyFile, evaluate
from manyhands.training.run import TrainingRun
from manyhands.training.run_folder import RunFolder

pytest.importorskip("h5py", reason="h5py is not installed: make test installs it")
pytest.importorskip("pyarrow", reason="pyarrow is not installed: make test installs it")

SHORT = ("--num-envs", "16", "--max-steps", "1600", "--episodes", "10", "--threads", "1")
DATASETS = {"npz": "shown.npz", "minari": "expert-v0", "lerobot": "shown"}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run and datasets of Reach, and files that are none."""
    folder = tmp_path_factory.mktemp("made")
    assert cli.main(["train", "PandaReach", *SHORT, "--runs", str(folder / "runs")]) == 0
    (run,) = (folder / "runs").iterdir()
    run.rename(folder / "run")
    (folder / "runs").rmdir()
    for format, name in DATASETS.items():
        command = ["demos", "PandaReach", "-n", "4", "--format", format, "--out", str(folder / name)]
        assert cli.main(command) == 0
    (folder / "garbage").write_bytes(bytes(range(256)) * 40)
    shutil.copy(folder / "garbage", folder / "garbage.onnx")
    model = onnx.load(folder / "run" / "policy.onnx")
    model.graph.input[0].name = "picture"
    for node in model.graph.node:
        node.input[:] = ["picture" if name == "observation" else name for name in node.input]
    onnx.save(model, folder / "other.onnx")
    true = onnx.helper.make_tensor("", onnx.TensorProto.BOOL, [], [True])
    ends = {
        "one_number.onnx": [onnx.helper.make_node("ReduceSum", ["action"], ["end"], keepdims=0)],
        "endless.onnx": [
            onnx.helper.make_node("Constant", [], ["always"], value=true),
            onnx.helper.make_node("Loop", ["", "always", "action"], ["end"], body=_body()),
        ],
    }
    for name, nodes in ends.items():
        model = onnx.load(folder / "run" / "policy.onnx")
        model.graph.node.extend(nodes)
        del model.graph.output[:]
        model.graph.output.append(onnx.helper.make_tensor_value_info("end", onnx.TensorProto.FLOAT, None))
        onnx.save(model, folder / name)
    return folder


def _body() -> onnx.GraphProto:
    """Of a loop that never ends."""
    info, bools, floats = onnx.helper.make_tensor_value_info, onnx.TensorProto.BOOL, onnx.TensorProto.FLOAT
    nodes = [onnx.helper.make_node("Identity", [a], [b]) for a, b in (("again", "still"), ("x", "y"))]
    inputs = [info("i", onnx.TensorProto.INT64, []), info("again", bools, []), info("x", floats, None)]
    return onnx.helper.make_graph(nodes, "body", inputs, [info("still", bools, []), info("y", floats, None)])


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


REQUESTS = [
    # Ids
    ("train PandaReech", "PandaReech"),
    ("sweep PandaReech", "PandaReech"),
    ("demos PandaReech", "PandaReech"),
    ("record PandaReech", "PandaReech"),
    ("view PandaReech", "PandaReech"),
    ("evaluate run --env PandaReech", "PandaReech"),
    ("clone shown.npz --env PandaReech", "PandaReech"),
    # Folders where nothing can be written
    ("train PandaReach --runs /proc/x", "/proc/x"),
    ("sweep PandaReach --out /proc/x", "/proc/x"),
    ("demos PandaReach -n 1 --format npz --out /proc/x/a.npz", "/proc/x"),
    ("demos PandaReach -n 1 --out /proc/x/a-v0", "/proc/x"),
    ("clone shown.npz --out /proc/x/a.onnx", "/proc/x"),
    ("record PandaReach --episodes 1 --out /proc/x/a.gif", "/proc/x"),
    ("compare run --out /proc/x/a", "/proc/x"),
    ("train PandaReach --runs garbage", "garbage"),
    ("sweep PandaReach --out garbage", "garbage"),
    # Policies of another task, of none, and no policies
    ("evaluate run --env PandaPush", "does not fit PandaPush-v3"),
    ("view PandaPush --policy run", "does not fit PandaPush-v3"),
    ("record PandaPush --policy run", "does not fit PandaPush-v3"),
    ("demos PandaPush --policy run", "does not fit PandaPush-v3"),
    ("evaluate other.onnx --env PandaReach", "is no goal policy"),
    ("evaluate one_number.onnx --env PandaReach", "end should have a row for each world"),
    ("evaluate endless.onnx --env PandaReach", "endless.onnx has a Loop, which need not end"),
    ("evaluate garbage.onnx --env PandaReach", "garbage.onnx"),
    ("view PandaReach --policy garbage.onnx", "garbage.onnx"),
    ("record PandaReach --policy garbage.onnx", "garbage.onnx"),
    ("demos PandaReach --policy garbage.onnx", "garbage.onnx"),
    ("evaluate nowhere", "nowhere"),
    # Datasets of another task, and none
    ("clone shown.npz --env PandaPush", "PandaPush"),
    ("clone shown --env PandaPush", "PandaPush"),
    ("clone expert-v0 --env PandaReachJoints", "PandaReachJoints"),
    ("clone garbage", "garbage"),
    ("clone nowhere", "nowhere"),
    # Runs that are none
    ("train --resume garbage", "garbage"),
    ("compare garbage", "garbage"),
    # Trainings that cannot go on
    ("train PandaReach --set replay_capacity=2000000000", "which takes about 210 GB of memory, and"),
    ("train PandaReach --num-envs 100000000", "of memory, and"),
    ("train PandaReach --num-envs 100000000000", "of memory, and"),
    ("train PandaReach --set evaluation_episodes=100000000", "of memory, and"),
    ("sweep PandaReach --num-envs 100000000 --jobs 2", "are free for each of 2 runs at a time: at most"),
    ("train PandaReach --set replay_folder=/nowhere", "cannot keep 95 MB in a file in '/nowhere': No such file"),
    ("train PandaReach --set algorithm=SAC --set num_critics=2 --set temperature=1e30", "training diverged"),
    ("train PandaReach --workers 2", "--ray"),
]


@pytest.mark.parametrize(("request_", "message"), REQUESTS, ids=[request for request, _ in REQUESTS])
def test_requests_that_cannot_be_met(
    request_: str, message: str, made: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(made)
    before = contents(made)
    assert cli.main(request_.split()) in (1, 2)
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith(f"manyhands {request_.split()[0]}: ") and message in line
    if message == "training diverged":  # after its first checkpoint
        shutil.rmtree(made / "runs")
    assert contents(made) == before


def damaged(data: bytes, chance: random.Random) -> bytes:
    """Cut off, or with a bit, eight bytes or 64 bytes that are other ones."""
    at = chance.randrange(len(data))
    wrong = [b"", bytes([data[at] ^ 1 << chance.randrange(8)]), b"\xff" * 8, chance.randbytes(64)][chance.randrange(4)]
    return data[:at] + wrong + data[at + len(wrong) :] if wrong else data[:at]


def told(act: Callable[[], object]) -> None:
    """It succeeds, or says in one line why not."""
    try:
        act()
    except (ValueError, OSError) as error:
        assert "\n" not in str(error)


@pytest.fixture
def chance() -> random.Random:
    seed = random.SystemRandom().randrange(2**32)
    print(f"random.Random({seed})")
    return random.Random(seed)


def test_damaged_checkpoints_are_refused_and_change_nothing(made: Path, chance: random.Random, tmp_path: Path) -> None:
    whole = RunFolder(made / "run")
    run = TrainingRun(whole.read_settings(), whole.checkpoint)
    weights = [weight.copy() for weight, _ in run._trainer.policy().layers]
    data = whole.checkpoint.read_bytes()
    file = tmp_path / "checkpoint.bin"
    header = [data[:at] + bytes([data[at] ^ 255]) + data[at + 1 :] for at in range(32)]
    for bad in [*header, *(damaged(data, chance) for _ in range(100))]:
        file.write_bytes(bad)
        if bad == data:
            continue
        with pytest.raises(CheckpointError, match=r"checkpoint.bin: [^\n]+$"):
            run._trainer.load(file)
    assert all(np.array_equal(a, b) for a, (b, _) in zip(weights, run._trainer.policy().layers, strict=True))
    assert run._trainer.load(whole.checkpoint)


def test_damaged_policies_are_refused_or_act(made: Path, chance: random.Random, tmp_path: Path) -> None:
    """ONNX has no checksums: a weight that is another one is not found out."""
    data = (made / "run" / "policy.onnx").read_bytes()
    file = tmp_path / "policy.onnx"
    readers: list[Callable[[], object]] = [
        lambda: evaluate(PolicyFile(file), "PandaReach-v3", 2, 0, 1),
        lambda: read_policy(file),
    ]
    for _ in range(60):
        file.write_bytes(damaged(data, chance))
        for reader in readers:
            told(reader)


@pytest.mark.parametrize("format", DATASETS)
def test_damaged_datasets_are_refused_or_whole(format: str, made: Path, chance: random.Random, tmp_path: Path) -> None:
    spec = make_env_batch("PandaReach-v3", 1).spec
    source, copy = made / DATASETS[format], tmp_path / DATASETS[format]
    files = [source] if source.is_file() else sorted(path for path in source.rglob("*") if path.is_file())
    for file in files:
        for _ in range(40 // len(files)):
            if source.is_file():
                copy.write_bytes(damaged(file.read_bytes(), chance))
            else:
                shutil.rmtree(copy, ignore_errors=True)
                shutil.copytree(source, copy)
                (copy / file.relative_to(source)).write_bytes(damaged(file.read_bytes(), chance))
            told(lambda: read(copy).checked(copy, spec))


def limited(kilobytes: int, folder: Path, request: str) -> "subprocess.CompletedProcess[str]":
    """Runs a command that can write files of so many kilobytes, which stands for a disk that is full."""
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    limit = 1024 * kilobytes

    def lower() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.run(
        [sys.executable, "-c", program, *request.split()],
        cwd=folder, preexec_fn=lower, capture_output=True, text=True, timeout=120,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("request_", "kilobytes"),
    [
        (f"train PandaReach {' '.join(SHORT)}", 1),  # not even the config
        (f"train PandaReach {' '.join(SHORT)}", 16),  # no checkpoint
        ("train --resume run --max-steps 8000", 1),
        ("train --resume run --max-steps 8000", 4),  # no metrics, no events
        ("train --resume run --max-steps 8000", 200),  # no checkpoint, later
        ("clone shown.npz --steps 10", 1),
        ("compare run", 1),
        ("record PandaReach --episodes 1 --out a.gif", 1),
        ("record PandaReach --episodes 1 --out a.mp4", 1),
    ],
)
def test_a_full_disk_is_told_in_one_line_and_loses_nothing(
    request_: str, kilobytes: int, made: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "made"
    shutil.copytree(made, folder)
    before = contents(folder)
    result = limited(kilobytes, folder, request_)
    assert result.returncode == 2, result
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"manyhands {request_.split()[0]}: ")
    after = contents(folder)
    written = {name for name in after if after[name] != before.get(name)} - {"run/config.json", "run/metrics.csv"}
    assert not (before.keys() - after.keys() - {"run/evaluation.json"}), "nothing is gone"
    assert not written & before.keys(), "nothing that was there is another"
    assert all("events" in name for name in written), written
    if request_.startswith("train --resume"):
        assert cli.main(["train", "--resume", str(folder / "run"), "--max-steps", "3200"]) == 0, "it still can be"
