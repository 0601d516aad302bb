"""Files that appear whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, moved to it if the block ends well and removed if not.

    Raises OSError, of the fitting kind, before the block if nothing can be written there.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {path.parent} to write {path.name} to")
    if path.is_dir():
        raise IsADirectoryError(f"{path} is a folder; name a file")
    try:
        temporary.touch()
    except OSError as reason:
        text = f"{path} cannot be written ({reason.strerror}); name a place where files can be"
        raise type(reason)(text) from reason
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def replacing_folder(path: Path, force: bool = False) -> Iterator[Path]:
    """The same of a folder: an empty one beside `path`, to be filled. What is there already is replaced with `force`.

    Raises FileExistsError without it, and OSError, of the fitting kind, if nothing can be written there.
    """
    require_new(path, force)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.mkdir(parents=True)
    except OSError as reason:
        text = f"{path} cannot be written ({reason.strerror}); name a place where files can be"
        raise type(reason)(text) from reason
    try:
        yield temporary
        old = temporary.with_name(f"{temporary.name}.old")
        if path.exists():
            path.rename(old)
        temporary.rename(path)
        _remove(old)
    finally:
        _remove(temporary)


def require_new(path: Path, force: bool) -> None:
    """Raises FileExistsError if there is something already that must not be replaced."""
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists already: name another place, or replace it with --force")


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Writes a whole text file."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
