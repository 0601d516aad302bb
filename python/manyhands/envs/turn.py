"""One call at a time."""

import os
import threading
import weakref
from types import TracebackType


class Turn:
    """A lock, to be used in a `with`, that a child of fork() finds open: whoever held it is not there."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        _turns.add(self)

    def __enter__(self) -> None:
        self._lock.acquire()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._lock.release()

    def open(self) -> None:
        """For a child of fork()."""
        self._lock = threading.Lock()


_turns: "weakref.WeakSet[Turn]" = weakref.WeakSet()


def _open_all() -> None:
    for turn in list(_turns):
        turn.open()


os.register_at_fork(after_in_child=_open_all)
