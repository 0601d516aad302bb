"""One process at a time writes to a folder."""

import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from manyhands.files import naming

_NAME = ".lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Nobody else trains in the folder meanwhile. The system lets go of the lock however this process ends.

    Raises BlockingIOError that names the process if one trains there, OSError if nothing can be written there.
    """
    path = folder / _NAME
    with naming(path):
        file = _claim(path)
    try:
        yield
    finally:
        path.unlink(missing_ok=True)  # still locked: who waits for the old file finds that it is gone
        os.close(file)


def _claim(path: Path) -> int:
    """The locked file, which says who holds it."""
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(file, path)
            if _is_at(file, path):
                os.truncate(file, 0)
                os.pwrite(file, f"process {os.getpid()} on {socket.gethostname()}".encode(), 0)
                return file
        except BaseException:
            os.close(file)
            raise
        os.close(file)  # its holder has removed it in the meantime


def _lock(file: int, path: Path) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = os.pread(file, 300, 0).decode(errors="replace") or "another process"
        raise BlockingIOError(f"{holder} trains in {path.parent} already: wait until it ends, or end it") from None
    except OSError:
        pass  # file systems of clusters may have no locks, and should train nonetheless


def _is_at(file: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file), path.stat())
    except FileNotFoundError:
        return False
