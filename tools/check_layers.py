"""Fails on an include that the layer table of docs/architecture.md forbids.

The table `| folder | holds | may use |` is the law. A layer may include itself, what its third column names, and what
those may use in turn. A name that ends in `.h` allows that one header; `<name>` allows a third-party library to this
layer alone. `everything` lifts all limits.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
STANDARD = re.compile(r"^[a-z_0-9]+$")  # <vector>, <cmath>: neither dot nor slash


@dataclass
class Layer:
    """One row of the table."""

    folder: str
    layers: set[str] = field(default_factory=set)
    headers: set[str] = field(default_factory=set)
    libraries: set[str] = field(default_factory=set)
    unlimited: bool = False


def read_table(document: Path) -> dict[str, Layer]:
    """The layers by folder, `layers` closed under "may use". Raises ValueError if the table is missing or names an
    unknown folder."""
    rows = re.findall(r"^\| `(manyhands/[\w/]+|bindings)` \|[^|]*\|([^|]*)\|", document.read_text(), re.MULTILINE)
    if not rows:
        raise ValueError(f"{document}: no layer table `| folder | holds | may use |` found")
    table: dict[str, Layer] = {}
    for folder, allowed in rows:
        layer = table[folder] = Layer(folder, unlimited="everything" in allowed)
        for name in re.findall(r"`([^`]+)`", allowed):
            if name.startswith("<"):
                layer.libraries.add(name.strip("<>"))
            elif name.endswith(".h"):
                layer.headers.add(name)
            else:
                layer.layers.add(name)
    for layer in table.values():
        if unknown := layer.layers - table.keys():
            raise ValueError(f"{document}: `{layer.folder}` may use {sorted(unknown)}, which are not rows of the table")
    for layer in table.values():
        todo = list(layer.layers)
        while todo:
            new = table[todo.pop()].layers - layer.layers
            layer.layers |= new
            todo += new
        if layer.folder in layer.layers:
            raise ValueError(f"{document}: `{layer.folder}` depends on itself")
    return table


def layer_of(path: str, table: dict[str, Layer]) -> Layer | None:
    """The layer of the deepest folder that holds `path`, a path from the root of the tree."""
    folders = [folder for folder in table if path.startswith(folder + "/")]
    return table[max(folders, key=len)] if folders else None


def complaint(include: str, quoted: bool, layer: Layer, table: dict[str, Layer]) -> str | None:
    """What is wrong with an include in a file of `layer`, or None."""
    if layer.unlimited:
        return None
    if not quoted:
        library = re.split(r"[/.]", include)[0]
        if STANDARD.match(include) or library in layer.libraries:
            return None
        return f"<{include}> is not a library that `{layer.folder}` may use"
    if include in layer.headers:
        return None
    target = layer_of(include, table)
    if target is None:
        return f'"{include}" is in no layer; includes are written from the root: "manyhands/..."'
    if target.folder != layer.folder and target.folder not in layer.layers:
        return f'"{include}": `{layer.folder}` may not use `{target.folder}`'
    return None


def check(root: Path) -> list[str]:
    """Every forbidden include under `root`, as `file:line: message`."""
    table = read_table(root / "docs/architecture.md")
    found: list[str] = []
    for top in ("manyhands", "bindings"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in (".h", ".cpp", ".inl"):
                continue
            name = path.relative_to(root).as_posix()
            layer = layer_of(name, table)
            if layer is None:
                found.append(f"{name}:1: this folder is in no row of the layer table")
                continue
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if match := INCLUDE.match(line):
                    quoted, angled = match.groups()
                    if message := complaint(quoted or angled, quoted is not None, layer, table):
                        found.append(f"{name}:{number}: {message}")
    return found


if __name__ == "__main__":
    complaints = check(Path(__file__).resolve().parent.parent)
    print("\n".join([*complaints, f"{len(complaints)} forbidden includes (docs/architecture.md, Layers)"]))
    sys.exit(bool(complaints))
