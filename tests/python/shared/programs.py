"""Programs in processes of their own, in which PyBullet's own module may stand for ours."""

import os
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

STUB = """
import sys
from importlib.machinery import ExtensionFileLoader, PathFinder
from importlib.util import module_from_spec

for entry in sys.path:
    spec = PathFinder.find_spec("pybullet", [entry])
    if spec is not None and isinstance(spec.loader, ExtensionFileLoader):
        sys.modules["manyhands.pybullet"] = module_from_spec(spec)
        spec.loader.exec_module(sys.modules["manyhands.pybullet"])
        sys.modules.pop("pybullet", None)
        break
"""
"""What a process runs first: it has PyBullet, which knows nothing of its place."""


def run(
    folder: Path, *arguments: str, program: str = "", stub: bool = False, paths: tuple[Path, ...] = ()
) -> subprocess.CompletedProcess[str]:
    """Python with arguments; `program` is put in the folder, and runs if there are no arguments."""
    if program:
        (folder / "program.py").write_text(dedent(program))
    path = [str(each) for each in paths]
    if stub:
        hooks = folder / "hooks"
        hooks.mkdir(exist_ok=True)
        (hooks / "sitecustomize.py").write_text(STUB)
        path.append(str(hooks))
    before = os.environ.get("PYTHONPATH")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*path, *([before] if before else [])])}
    command = [sys.executable, *(arguments or ("program.py",))]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)


def output(folder: Path, program: str, *arguments: str, stub: bool = False, paths: tuple[Path, ...] = ()) -> str:
    """What a program prints that ends well."""
    done = run(folder, *arguments, program=program, stub=stub, paths=paths)
    assert done.returncode == 0, done.stderr
    return done.stdout
