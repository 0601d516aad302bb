"""Which files there are, and which of them make a sample."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

KINDS = (".xml", ".mjcf")


@dataclass(frozen=True)
class File:
    """A scene of somebody's. `name`: collection and path within it, by which results are known."""

    name: str
    collection: str
    path: Path


def files_in(folder: Path, collection: str) -> list[File]:
    """All that may be a scene, sorted; whether it is one, MuJoCo says."""
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in KINDS and path.is_file())
    return [File(f"{collection}/{path.relative_to(folder)}", collection, path.resolve()) for path in found]


def matching(files: Iterable[File], patterns: Sequence[str]) -> list[File]:
    """Those whose name holds, or as a shell pattern is, one of `patterns`; all, if there is none."""
    if not patterns:
        return list(files)
    return [file for file in files if any(p in file.name or fnmatch(file.name, p) for p in patterns)]


def sample(files: Sequence[File], count: int) -> list[File]:
    """`count` of them, always the same, evenly spread: each collection by its share, but at least one of each."""
    if count >= len(files):
        return list(files)
    order = sorted(files, key=lambda file: (file.collection, file.name))
    groups: dict[str, list[File]] = {}
    for file in order:
        groups.setdefault(file.collection, []).append(file)
    firsts = [spread(group, 1)[0] for group in groups.values()][:count]
    rest = [file for file in order if file not in firsts]
    return sorted([*firsts, *spread(rest, count - len(firsts))], key=lambda file: (file.collection, file.name))


def spread(files: Sequence[File], count: int) -> list[File]:
    """`count` of them at equal distances, the ends as far as the middle from each other."""
    return [files[(2 * k + 1) * len(files) // (2 * count)] for k in range(count)]
