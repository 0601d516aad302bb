"""What to say where a package is missing that only some programs need."""

import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, requires


def pip_install(*requirements: str) -> str:
    """The command that installs them for the Python that runs, whatever the shell's PATH is."""
    return shlex.join([sys.executable or "python3", "-m", "pip", "install", *requirements])


def install_extra(extra: str) -> str:
    """The command that installs what an extra of this package names."""
    try:
        given = [each.partition(";") for each in requires("manyhands") or []]
    except PackageNotFoundError:  # run from a source tree
        given = []
    named = [package.strip() for package, _, marker in given if re.search(rf"extra == ['\"]{extra}['\"]", marker)]
    return pip_install(*(named or [f"manyhands[{extra}]"]))


@contextmanager
def needs(extra: str, what: str) -> Iterator[None]:
    """Where an import in the block finds no package, the error says how to install it."""
    try:
        yield
    except ModuleNotFoundError as reason:
        if reason.name is None or reason.name.startswith("manyhands"):
            raise
        package = reason.name.partition(".")[0]
        raise ModuleNotFoundError(f"{what} needs {package}: {install_extra(extra)}", name=package) from reason
