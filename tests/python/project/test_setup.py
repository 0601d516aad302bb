"""What `make` installs, by `make` itself: it only tells here."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("target", ["train", "build"])
def test_the_commands_of_the_readme_have_their_packages(target: str) -> None:
    """The page, plots and videos too: the README shows them right after `make train`."""
    told = subprocess.run(
        ["make", "--dry-run", "--always-make", target], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    names = {name for line in re.findall(r"tools/setup\.sh python (.*)", told) for name in line.split()}
    listed = subprocess.run(
        [sys.executable, "tools/requirements.py", *names], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    packages = {re.split(r"[=><;\[ ]", line)[0] for line in listed.splitlines()}
    assert packages >= {"numpy", "gymnasium", "onnxruntime", "rich", "viser", "imageio-ffmpeg", "pillow", "plotly"}
