"""`manyhands train` where numpy and gymnasium are all there is."""

import subprocess
import sys
from pathlib import Path

from manyhands import cli

PROGRAM = """
import sys
for name in ("rich", "matplotlib", "onnx", "onnxruntime", "plotly", "tensorboard"):
    sys.modules[name] = None
from manyhands import cli
sys.exit(cli.main(sys.argv[1:]))
"""


def test_a_task_is_learned_and_what_was_left_out_is_written_later(tmp_path: Path) -> None:
    told = subprocess.run(
        [sys.executable, "-c", PROGRAM, "train", "PandaReach", "--episodes", "10", "--runs", str(tmp_path)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    lines = [line for line in told.stdout.splitlines() if line.startswith("There will be")]
    assert len(lines) == 1
    assert "no progress bar, no learning_curve.png, no policy.onnx, no TensorBoard events: " in lines[0]
    assert "pip install" in lines[0]
    assert "Solved: success" in told.stdout
    (run,) = tmp_path.iterdir()
    left = {"config.json", "metrics.csv", "checkpoint.bin", "evaluation.json"}
    assert {path.name for path in run.iterdir()} == left

    assert cli.main(["train", "--resume", str(run)]) == 0
    assert {path.name for path in run.iterdir()} == left | {"learning_curve.png", "policy.onnx"}
