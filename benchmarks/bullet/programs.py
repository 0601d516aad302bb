"""What there is to run in the wheel of PyBullet: its scripts, and the environments that pybullet_envs registers."""

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

FOLDERS = ("pybullet_examples", "pybullet_envs", "pybullet_robots", "pybullet_utils/examples")
ARGUMENTS = {
    "pybullet_envs/examples/testEnv.py": ("--steps", "1000"),  # its default is one step
    "pybullet_envs/deep_mimic/testrl.py": ("--arg_file", "run_humanoid3d_walk_args.txt"),
}
"""What scripts are given that do nothing, or not much, without."""

SCRIPT, ENVIRONMENT = "script", "environment"


@dataclass(frozen=True)
class Program:
    """One that is run. `name`: its path in the wheel, or its id in gym; `kind`: SCRIPT or ENVIRONMENT."""

    name: str
    kind: str
    path: Path
    arguments: tuple[str, ...] = ()


def wheel() -> Path:
    """Where pybullet's packages lie. Raises FileNotFoundError if they are not installed."""
    spec = find_spec("pybullet_envs")
    if spec is None or spec.origin is None:
        raise FileNotFoundError("pybullet is not installed, which is what this compares with: pip install pybullet")
    return Path(spec.origin).resolve().parent.parent


def scripts(folder: Path) -> list[Program]:
    """All files that do something when run."""
    found = sorted(path for inner in FOLDERS for path in (folder / inner).rglob("*.py") if does_something(path))
    names = [str(path.relative_to(folder)) for path in found]
    return [Program(name, SCRIPT, path, ARGUMENTS.get(name, ())) for name, path in zip(names, found, strict=True)]


def does_something(path: Path) -> bool:
    """Whether a file is more than definitions: it asks whether it is the main module, or has a loop of its own, or
    calls pybullet."""
    body = ast.parse(path.read_bytes()).body
    aliases = {
        name.asname or name.name
        for node in body
        if isinstance(node, ast.Import)
        for name in node.names
        if name.name == "pybullet"
    }
    return any(is_main_guard(node) or isinstance(node, ast.While) or calls(node, aliases) for node in body)


def is_main_guard(node: ast.stmt) -> bool:
    """`if __name__ == "__main__":`."""
    if not (isinstance(node, ast.If) and isinstance(node.test, ast.Compare)):
        return False
    return isinstance(node.test.left, ast.Name) and node.test.left.id == "__name__"


def calls(node: ast.stmt, aliases: set[str]) -> bool:
    """Whether a statement is a call, for its effect, of something other than the set-up of a module."""
    if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
        return False
    function = node.value.func
    return isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name) and function.value.id in aliases


def environments(folder: Path) -> list[Program]:
    """Those of pybullet_envs, in the order of their registration."""
    module = folder / "pybullet_envs" / "__init__.py"
    return [Program(name, ENVIRONMENT, module) for name in dict.fromkeys(registered(ast.parse(module.read_bytes())))]


def registered(tree: ast.Module) -> Iterator[str]:
    """The ids in a module's calls of `register`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "register":
            for keyword in node.keywords:
                if keyword.arg == "id" and isinstance(keyword.value, ast.Constant):
                    yield str(keyword.value.value)


def matching(programs: Sequence[Program], patterns: Sequence[str]) -> list[Program]:
    """Those whose names hold one of `patterns`; all, if there is none."""
    return [program for program in programs if not patterns or any(pattern in program.name for pattern in patterns)]
