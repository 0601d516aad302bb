"""`python -m manyhands.compat PROGRAM`: runs a program as Python does, with our modules in the places of others."""

import argparse
import builtins
import os
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from manyhands.compat.names import NAMES, install_as

_DESCRIPTION = """\
Runs a program written for PyBullet, panda-gym 2 or the old gym on manyhands, without a change to it.
`import pybullet`, `pybullet_data`, `pybullet_utils`, `panda_gym` and `gym` give manyhands' modules in the program and
in the processes that it starts; all else is as `python program.py` has it.
"""
_EXAMPLES = """\
examples:
  python -m manyhands.compat hello_pybullet.py
  python -m manyhands.compat train.py --steps 1000     what stands after the program goes to it
  python -m manyhands.compat -m pybullet_envs.examples.testEnv
  python -m manyhands.compat --keep gym program.py     its gym is the installed one

Inside a program the same is one line, before the other imports:
  import manyhands; manyhands.install_as("pybullet", "pybullet_data")
"""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m manyhands.compat", description=_DESCRIPTION, epilog=_EXAMPLES, allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        usage="%(prog)s [-h] [--keep NAME] (program.py | -m MODULE) [argument ...]",
    )  # fmt: skip
    parser.add_argument(
        "--keep", action="append", choices=list(NAMES), default=[], metavar="NAME",
        help="a name that goes on meaning the installed package; may be given more than once",
    )  # fmt: skip
    parser.add_argument("-m", dest="module", metavar="MODULE", help="a module to run in place of a program")
    parser.add_argument("program", nargs="?", help="the program's file")
    return parser


def _split(arguments: Sequence[str]) -> tuple[Sequence[str], Sequence[str]]:
    """Our own arguments, up to the program's or module's name, and its."""
    at = 0
    while at < len(arguments):
        word = arguments[at]
        if word.startswith("-m") or not word.startswith("-"):
            end = at + (2 if word == "-m" else 1)
            return arguments[:end], arguments[end:]
        at += 2 if word == "--keep" else 1
    return arguments, ()


def main(arguments: Sequence[str]) -> int:
    """Runs the program; returns the exit code, 2 for a request that makes no sense, unless the program exits itself."""
    ours, its = _split(arguments)
    parser = _parser()
    given = parser.parse_args(ours)
    if given.module is None and given.program is None:
        parser.error("name a program or -m MODULE to run; -h shows examples")
    if given.module is None and not Path(given.program).is_file():
        parser.error(f"there is no file {given.program!r} to run")
    names = [name for name in NAMES if name not in given.keep]
    if names:
        install_as(*names)
        _tell_children(names)
    sys.argv = [given.program or given.module, *its]
    if given.module is not None:
        runpy.run_module(given.module, run_name="__main__", alter_sys=True)
        return 0
    return _run(given.program)


def _tell_children(names: Sequence[str]) -> None:
    """Processes that the program starts find the names along their path."""
    folders = [str(Path(__file__).parent / "stand_ins" / name) for name in names]
    sys.path[1:1] = folders
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([*folders, *([before] if before else [])])


def _run(program: str) -> int:
    """Runs a file as the main module. What it raises is shown as Python shows it, without our part of the way."""
    path = os.path.abspath(program)  # noqa: PTH100  links keep their names, as in Python
    if not getattr(sys.flags, "safe_path", False):
        sys.path[0] = str(Path(path).resolve().parent)
    module = ModuleType("__main__")
    module.__file__ = path
    vars(module)["__builtins__"] = builtins
    sys.modules["__main__"] = module
    try:
        code = compile(Path(path).read_bytes(), path, "exec", dont_inherit=True)
        exec(code, vars(module))
    except Exception as error:
        error.__traceback__ = error.__traceback__ and error.__traceback__.tb_next
        sys.excepthook(type(error), error, error.__traceback__)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
