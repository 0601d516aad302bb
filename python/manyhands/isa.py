"""Which build of the extension runs, imported before all that needs it.

An installation has the extension as it was compiled for the machine, or once for each of several instruction sets, in
folders of their names. Then the best that the processor has is chosen, or the one that the environment variable
MANYHANDS_ISA names.
"""

import os
import sys
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from manyhands._processor import instruction_sets

_NATIVE = "native"


def choose(built: Collection[str], processor: Sequence[str], wanted: str) -> str:
    """The instruction set that is used, of those of the installation and the processor's, best first.

    wanted: if not empty, this one. Raises ImportError, which says in a line what is missing.
    """
    if wanted:
        if wanted not in built:
            raise _refusal(f"MANYHANDS_ISA is {wanted!r}, but this installation has {', '.join(sorted(built))}")
        if wanted not in (*processor, _NATIVE):
            raise _refusal(f"MANYHANDS_ISA is {wanted}, but this processor has {_listed(processor)}")
        return wanted
    for isa in (_NATIVE, *processor):
        if isa in built:
            return isa
    raise _refusal(
        f"manyhands is built for processors with {' or '.join(sorted(built))}, this one has {_listed(processor)}; "
        "a build from source runs on it (docs/installing.md)"
    )


def _refusal(text: str) -> ImportError:
    return ImportError(text, name="manyhands._core")


def _listed(isas: Sequence[str]) -> str:
    return ", ".join(isas) or "neither AVX2 nor FMA"


def _folders() -> dict[str, Path]:
    """Where the extension lies, by instruction set."""
    package = Path(__file__).parent
    found = {_NATIVE: package} if any(package.glob("_core.*")) else {}
    return found | {path.parent.name: path.parent for path in package.glob("*/_core.*")}


_built = _folders()
_chosen = choose(_built, instruction_sets(), os.environ.get("MANYHANDS_ISA", ""))
if _chosen != _NATIVE:
    sys.modules["manyhands"].__path__.append(str(_built[_chosen]))

try:
    VERSION = version("manyhands")
except PackageNotFoundError:  # run from a source tree
    VERSION = "0"


@dataclass(frozen=True)
class BuildInfo:
    """What runs: the library's version, and how it was built."""

    version: str
    isa: str
    """Instruction set of the kernels: x86-64-v3, x86-64-v4, armv8; or native, that of the machine which built it."""
    isas: tuple[str, ...]
    """Those that this installation has."""
    processor: tuple[str, ...]
    """Those that this processor has, best first."""
    lanes: int
    """Worlds in a SIMD register."""
    compiler: str


def build_info() -> BuildInfo:
    """How the library that runs was built, and for which processors."""
    from manyhands._core import build_info as core

    return BuildInfo(version=VERSION, isas=tuple(sorted(_built)), processor=tuple(instruction_sets()), **core())
