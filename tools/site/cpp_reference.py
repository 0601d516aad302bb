"""The C++ reference: a page for each folder of headers, written from what the headers say of themselves."""

import re
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from tools.site.cpp_symbols import Header, Symbol, read_header

# Not for users to include: templates behind other headers' declarations, kernels, parsers' parts.
INNER = re.compile(
    r"_impl\.h$|_kernel\.h$|/(instantiate|vector_builtins|panda_tasks|policy_archive|world_checks|part_checks)\.h$"
    r"|^bullet/(?!client\.h)|^model/io/(json|mesh_shelf)\.h$|^model/io/(mjcf|urdf|sdf)/\w+_|^model/io/image/"
    r"|^model/io/save/(?!save\.h)|^physics/collision/(closed_form|general|broad|surface)/"
    r"|^physics/contact/(?!settings\.h)|^physics/dynamics/(field|checks|articulated_inertia|yielding)\.h$"
    r"|^kinematics/ik_goals\.h$|^render/(rays|sample_rays|frame)\.h$"
)
INTRODUCTION = """\
# C++

What the headers declare, in the words of their comments. Include by the path shown, link with `manyhands::manyhands`
({doc}`../../contributing`); everything lies in the namespace `manyhands`. [How the folders build on each
other](../../architecture.md).

| folder | headers | declares |
| --- | --- | --- |
"""


def public_headers(root: Path) -> list[Path]:
    """The headers that users include."""
    top = root / "manyhands"
    return [path for path in sorted(top.rglob("*.h")) if not INNER.search(path.relative_to(top).as_posix())]


def folder_of(path: Path) -> Path:
    """Where a header lies."""
    return path.parent


def write_cpp_reference(root: Path, out: Path) -> None:
    """Writes the pages into `out`, with an index."""
    out.mkdir(parents=True, exist_ok=True)
    index, entries = INTRODUCTION, []
    for folder, paths in groupby(sorted(public_headers(root), key=folder_of), key=folder_of):
        headers = {path.relative_to(root).as_posix(): read_header(path) for path in paths}
        headers = {name: header for name, header in headers.items() if header.symbols}
        if not headers:
            continue
        name = folder.relative_to(root / "manyhands").as_posix()
        page = name.replace("/", "_")
        (out / f"{page}.md").write_text(folder_page(name, headers))
        kinds = [symbol.name for header in headers.values() for symbol in header.symbols if symbol.members]
        shown = ", ".join(f"`{kind}`" for kind in kinds[:4]) + (" ..." if len(kinds) > 4 else "")
        index += f"| [{name}]({page}.md) | {len(headers)} | {shown} |\n"
        entries.append(page)
    toctree = "\n".join(entries)
    (out / "index.md").write_text(f"{index}\n```{{toctree}}\n:hidden:\n:maxdepth: 1\n\n{toctree}\n```\n")


def folder_page(name: str, headers: dict[str, Header]) -> str:
    """The page of a folder."""
    parts = [f"# {name}\n"]
    for path, header in headers.items():
        parts.append(f'## {Path(path).name}\n\n{prose(header.summary)}\n\n```cpp\n#include "{path}"\n```\n')
        for symbols in by_name(header.symbols):
            parts += section(symbols)
    return "\n".join(parts)


def by_name(symbols: list[Symbol]) -> Iterator[list[Symbol]]:
    """Overloads together, in the order of the header."""
    for _, group in groupby(symbols, key=lambda symbol: (symbol.kind, symbol.name)):
        yield list(group)


def section(symbols: list[Symbol]) -> Iterator[str]:
    """A heading with the declarations of one name, what they do, and the members."""
    yield f"### `{symbols[0].name}`\n"
    for symbol in symbols:
        yield f"```cpp\n{wrapped(symbol.signature)}\n```\n"
        if symbol.comment and not symbol.shared:
            yield prose(symbol.comment) + "\n"
        yield from members(symbol)


def members(symbol: Symbol) -> Iterator[str]:
    """The public members of a class, the values of an enumeration, as a list of definitions."""
    for member in symbol.members:
        said = "" if member.shared else prose(member.comment)
        inner = [f"`{inner.signature}`" for inner in member.members]
        said = "\n".join(filter(None, [said, "Of " + ", ".join(inner) if inner else ""]))
        yield f"`` {bare(member.signature)} ``\n: {indented(said) or '&nbsp;'}\n"


def bare(signature: str) -> str:
    """A declaration without what tells a reader nothing."""
    return re.sub(r"\[\[nodiscard\]\] |MANYHANDS_INLINE |\binline |\bextern ", "", signature).replace("`", "'")


def wrapped(signature: str) -> str:
    """A declaration, its arguments on lines of their own where it is long."""
    signature = bare(signature)
    if len(signature) <= 100:
        return signature
    head, opening, rest = signature.partition("(")
    return f"{head}{opening}\n    " + rest.replace(", ", ",\n    ") if opening else signature


def prose(comment: str) -> str:
    """A comment as Markdown: stars, brackets and angles are meant as they stand; code in back-quotes stays."""
    lines = [line.strip() for line in comment.splitlines()]
    pieces = re.split(r"(`[^`]*`)", "\n".join(lines))
    return "".join(piece if piece.startswith("`") else escaped(piece) for piece in pieces).strip()


def escaped(words: str) -> str:
    """Words in which Markdown sees nothing but words, and lists."""
    words = re.sub(r"([*_<>\[\]|\\#~$])", r"\\\1", words)
    return re.sub(r"(?m)^([+=-]{1,}|\d+[.)])(?=\s*$|\s)", lambda m: m[0] if m[0] == "-" else "\\" + m[0], words)


def indented(words: str) -> str:
    """Lines that go on below a definition's first."""
    return words.replace("\n", "\n  ")
