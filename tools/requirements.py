"""Prints requirements of pyproject.toml, one a line, for `pip install -r`.

`build` means the build requirements, `core` the hard dependencies, anything else an extra of that name.
"""

import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pyright: ignore[reportMissingImports]


def requirements(names: list[str]) -> list[str]:
    """The requirements under `names`; extras that name other extras of the project are followed."""
    config = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())
    project = config["project"]
    groups = {
        "build": [*config["build-system"]["requires"], "cmake", "ninja"],
        "core": project["dependencies"],
        **project["optional-dependencies"],
    }
    found: list[str] = []
    for name in names:
        for requirement in groups[name]:
            own, _, extra = requirement.partition("[")
            found += requirements(extra.rstrip("]").split(",")) if own == project["name"] else [requirement]
    return found


if __name__ == "__main__":
    print("\n".join(requirements(sys.argv[1:])))
