"""Fails on an include or import that the layer tables of docs/architecture.md forbid, and on imports in a circle.

The tables `| folder | holds | may use |` are the law. A layer may use itself, what its third column names, and what
those may use in turn. A name that ends in `.h` allows that one header; `<name>` allows a third-party library to this
layer alone. `everything` lifts all limits. In Python, imports inside functions and for type checkers count as all do;
`manyhands._core`, `manyhands._processor` and the package's required dependencies are free.
"""

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')
STANDARD = re.compile(r"^[a-z_0-9]+$")  # <vector>, <cmath>: neither dot nor slash
ROW = re.compile(r"^\| `(manyhands/[\w/]+|bindings|python/[\w/.]+)` \|[^|\n]*\|([^|\n]*)\|", re.MULTILINE)
EXTENSIONS = ("manyhands._core", "manyhands._processor")
FREE = {*sys.stdlib_module_names, "gymnasium", "numpy", "typing_extensions"}  # to Python


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
    rows = ROW.findall(document.read_text())
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
    """The layer of the deepest row that holds `path`, a path from the root of the tree."""
    folders = [folder for folder in table if path == folder or path.startswith(folder + "/")]
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


def check_includes(root: Path, table: dict[str, Layer]) -> list[str]:
    """Every forbidden include under `root`, as `file:line: message`."""
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


def imports(file: Path) -> Iterator[tuple[int, str, str]]:
    """Lines of imports, wherever they stand, with the module and, of `from module import name`, the name."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            yield from ((node.lineno, module, alias.name) for alias in node.names)


def file_of(module: str, name: str, root: Path) -> str | None:
    """The file that an import reads, from the root of the tree; None if it is not of this tree."""
    for dotted in (f"{module}.{name}", module) if name else (module,):
        path = f"python/{dotted.replace('.', '/')}"
        for file in (f"{path}.py", f"{path}/__init__.py"):
            if (root / file).is_file():
                return file
    return None


def import_complaint(module: str, file: str | None, layer: Layer, table: dict[str, Layer]) -> str | None:
    """What is wrong with an import of `module`, which is `file`, in a file of `layer`, or None."""
    if layer.unlimited or module in EXTENSIONS or module.startswith("manyhands._core."):
        return None
    if file is None:
        package = module.partition(".")[0]
        if package in FREE or package in layer.libraries:
            return None
        return f"`{module}` is not a library that `{layer.folder}` may use"
    target = layer_of(file, table)
    if target is not None and target.folder != layer.folder and target.folder not in layer.layers:
        return f"`{module}`: `{layer.folder}` may not use `{target.folder}`"
    return None


def check_imports(root: Path, table: dict[str, Layer]) -> list[str]:
    """Every forbidden import under `root`, as `file:line: message`, and a circle if there is one."""
    found: list[str] = []
    graph: dict[str, set[str]] = {}
    for path in sorted((root / "python").rglob("*.py")):
        name = path.relative_to(root).as_posix()
        layer = layer_of(name, table)
        if layer is None:
            found.append(f"{name}:1: this folder is in no row of the layer table")
            continue
        for line, module, item in imports(path):
            file = file_of(module, item, root)
            if file is not None:
                graph.setdefault(name, set()).add(file)
            if message := import_complaint(module, file, layer, table):
                found.append(f"{name}:{line}: {message}")
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as circle:
        found.append(f"{circle.args[1][0]}:1: imports in a circle: {' <- '.join(circle.args[1])}")
    return found


def check(root: Path) -> list[str]:
    """Everything under `root` that the tables forbid, as `file:line: message`."""
    table = read_table(root / "docs/architecture.md")
    return check_includes(root, table) + check_imports(root, table)


if __name__ == "__main__":
    complaints = check(Path(__file__).resolve().parent.parent)
    print("\n".join([*complaints, f"{len(complaints)} forbidden includes and imports (docs/architecture.md, Layers)"]))
    sys.exit(bool(complaints))
