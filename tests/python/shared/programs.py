"""Programs in processes of their own."""

import os
import subprocess
import sys
from pathlib import Path
from textwrap import dedent


def run(
    folder: Path, *arguments: str, program: str = "", paths: tuple[Path, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Python with arguments; `program` is put in the folder, and runs if there are no arguments."""
    if program:
        (folder / "program.py").write_text(dedent(program))
    before = os.environ.get("PYTHONPATH")
    path = [*map(str, paths), *([before] if before else [])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path)}
    command = [sys.executable, *(arguments or ("program.py",))]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)


def output(folder: Path, program: str, *arguments: str, paths: tuple[Path, ...] = ()) -> str:
    """What a program prints that ends well."""
    done = run(folder, *arguments, program=program, paths=paths)
    assert done.returncode == 0, done.stderr
    return done.stdout
