"""Training with worlds on a Ray cluster: the same bits whatever is lost on the way."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from manyhands import cli
from manyhands.training.run_folder import RunFolder

pytest.importorskip("ray", reason="Ray is not installed: make interop does")
os.environ["RAY_USAGE_STATS_ENABLED"] = "0"

from ray.cluster_utils import Cluster

SETTINGS = (
    *("--num-envs", "24", "--threads", "1", "--episodes", "50", "--seed", "2"),
    *("--set", "stop_streak=0", "--set", "updates_per_iteration=4", "--set", "evaluation_interval=50"),
)


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    """Three nodes on this machine, of one processor each."""
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    for _ in range(2):
        nodes.add_node(num_cpus=1)
    nodes.wait_for_nodes()
    yield nodes
    nodes.shutdown()


def command(cluster: Cluster, parent: Path, steps: int, *arguments: str) -> list[str]:
    task = ("PandaPush", *SETTINGS, "--max-steps", str(steps), "--runs", str(parent))
    return ["train", *task, "--ray", cluster.address, "--workers", "3", *arguments]


def the_run(parent: Path) -> RunFolder:
    (path,) = parent.iterdir()
    return RunFolder(path)


def worker_processes(cluster: Cluster) -> list[int]:
    """Of our class, started by the raylets of this cluster."""
    raylets = {node.all_processes["raylet"][0].process.pid for node in cluster.list_all_nodes()}
    found = []
    for path in Path("/proc").glob("[0-9]*"):
        try:
            title = (path / "cmdline").read_bytes()
            parent = int((path / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:  # it has ended
            continue
        if title.startswith(b"ray::_Worker") and parent in raylets:
            found.append(int(path.name))
    return found


def when(condition: Callable[[], bool], act: Callable[[], object]) -> threading.Thread:
    """Does something in another thread as soon as a condition holds."""

    def wait() -> None:
        deadline = time.monotonic() + 200
        while not condition():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        act()

    thread = threading.Thread(target=wait)
    thread.start()
    return thread


def rows(parent: Path) -> int:
    return max((len(path.read_text().splitlines()) for path in parent.glob("*/metrics.csv")), default=0)


def start(arguments: list[str]) -> "subprocess.Popen[str]":
    program = "import sys; from manyhands.cli import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.Popen(
        [sys.executable, "-u", "-c", program, *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


def expect_same(run: RunFolder, other: RunFolder) -> None:
    assert run.checkpoint.read_bytes() == other.checkpoint.read_bytes()
    assert run.evaluation.read_text() == other.evaluation.read_text()


def test_losses_change_nothing(cluster: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = 12_000
    assert cli.main(command(cluster, tmp_path / "whole", steps)) == 0
    assert "steps/s of 3 workers" in (out := capsys.readouterr().out) and "lost" not in out
    whole = the_run(tmp_path / "whole")

    killed = when(lambda: rows(tmp_path / "killed") > 3, lambda: os.kill(worker_processes(cluster)[1], signal.SIGKILL))
    assert cli.main(command(cluster, tmp_path / "killed", steps)) == 0
    killed.join()
    assert "was lost; what it was doing is done again elsewhere" in capsys.readouterr().out
    expect_same(the_run(tmp_path / "killed"), whole)

    node = cluster.list_all_nodes()[-1]
    removed = when(lambda: rows(tmp_path / "node") > 3, lambda: cluster.remove_node(node, allow_graceful=False))
    assert cli.main(command(cluster, tmp_path / "node", steps)) == 0
    removed.join()
    assert "was lost; what it was doing is done again elsewhere" in capsys.readouterr().out
    expect_same(the_run(tmp_path / "node"), whole)


def test_a_run_goes_on_after_ctrl_c_and_after_a_kill(cluster: Any, tmp_path: Path) -> None:
    steps = 12_000
    assert cli.main(command(cluster, tmp_path / "whole", steps)) == 0

    process = start(command(cluster, tmp_path / "parted", steps))
    when(lambda: rows(tmp_path / "parted") > 3, lambda: os.killpg(process.pid, signal.SIGINT)).join()
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in err, err
    run = the_run(tmp_path / "parted")
    assert f"train --resume {run.path} --ray {cluster.address}" in out

    again = ["train", "--resume", str(run.path)]
    assert cli.main(again) == 2, "its worlds run on a cluster"
    process = start([*again, "--ray", cluster.address])
    count = rows(tmp_path / "parted")
    when(lambda: rows(tmp_path / "parted") > count, process.kill).join()
    process.communicate(timeout=60)
    assert cli.main([*again, "--ray", cluster.address]) == 0
    expect_same(run, the_run(tmp_path / "whole"))


def test_a_worker_that_never_lives_ends_the_run(
    cluster: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    over = threading.Event()

    def hunt() -> None:
        while not over.wait(0.02):
            for process in worker_processes(cluster)[:1]:
                os.kill(process, signal.SIGKILL)

    hunter = threading.Thread(target=hunt)
    hunter.start()
    try:
        assert cli.main(command(cluster, tmp_path, 10**9)) == 2
    finally:
        over.set()
        hunter.join()
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("manyhands train: worker ") and "times in a row" in line
    assert the_run(tmp_path).checkpoint.is_file()


def test_workers_for_whom_there_is_no_place_are_told(cluster: Any, tmp_path: Path) -> None:
    process = start([*command(cluster, tmp_path, 10**9)[:-1], "9"])
    guard = threading.Timer(90, process.kill)
    guard.start()
    assert process.stdout is not None
    expected = "Waiting for 6 of 9 workers. Of the cluster's 3 processors 0 are free."
    assert any(line.startswith(expected) for line in process.stdout)
    guard.cancel()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130 and not err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--ray", "127.0.0.1:1"], "no Ray cluster answers at '127.0.0.1:1'"),
        (["--ray", "nowhere"], "no Ray cluster can be used at 'nowhere'"),
        (["--ray", "local", "--workers", "0"], "--workers is 0"),
        (["--ray", "local", "--workers", "3", "--num-envs", "2"], "workers is 3"),
        (["--ray", "local", "--set", "algorithm=PPO"], "PPO"),
    ],
)
def test_what_cannot_be_is_told(
    arguments: list[str], message: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["train", "PandaReach", *arguments, "--runs", str(tmp_path)]) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("manyhands train: ") and message in line
    assert not list(tmp_path.iterdir())
