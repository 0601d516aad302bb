"""Files that appear whole or not at all."""

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """An OSError in the block that names no file, as those of writing, says that it was this one."""
    try:
        yield
    except OSError as reason:
        if reason.filename is not None or reason.strerror is None:
            raise
        raise type(reason)(f"{path} cannot be written ({reason.strerror})") from reason


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, moved to it if the block ends well and removed if not.

    Raises OSError, of the fitting kind, before the block if nothing can be written there.
    """
    if path.is_dir():
        raise IsADirectoryError(f"{path} is a folder; name a file")
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(8)}{path.suffix}")
    if not path.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {path.parent} to write {path.name} to")
    try:
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))  # nobody else's, and no link
    except OSError as reason:
        text = f"{path} cannot be written ({reason.strerror}); name a place where files can be"
        raise type(reason)(text) from reason
    try:
        with naming(path):
            yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def replacing_folder(path: Path, mark: str, force: bool = False) -> Iterator[Path]:
    """The same of a folder: an empty one beside `path`, to be filled. With `force` it takes the place of one that is
    there already, if that holds the file `mark`: nobody's home is lost.

    Raises FileExistsError on other folders and files, OSError, of the fitting kind, if nothing can be written there.
    """
    path = path.absolute()
    require_new(path, force, mark)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(8)}")
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
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def require_new(path: Path, force: bool, mark: str = "") -> None:
    """Raises FileExistsError if there is something that must not be replaced: with `force`, what lacks the file `mark`
    if that is named."""
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists already: name another place, or replace it with --force")
    if path.exists() and mark and not (path / mark).is_file():
        raise FileExistsError(f"{path} exists and is no dataset of this format: name another place")


def write_text(path: Path, text: str) -> None:
    """Writes a whole text file."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
