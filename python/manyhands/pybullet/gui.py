"""Windows: a client that is connected with GUI is shown by a page in the browser."""

import atexit
import os
import sys
import warnings
from typing import TYPE_CHECKING

from manyhands._core import pybullet_gui

if TYPE_CHECKING:
    from manyhands.pybullet.page import Page

SWITCH = "MANYHANDS_PYBULLET_GUI"
"""The environment variable that is 0 where no page is wanted."""

_pages: "dict[int, Page]" = {}


def page(client: int) -> "Page | None":
    """The page of a client; None of one that has none."""
    return _pages.get(client)


def listen() -> None:
    """Opens a page with each window from now on."""
    pybullet_gui.listen(_open, _close)
    atexit.register(_end)


def _open(client: int) -> None:
    """What goes wrong with a page leaves the program its window in software."""
    if os.environ.get(SWITCH) == "0":
        return
    try:
        from manyhands.pybullet.page import Page

        _pages[client] = Page(client, open_browser=_has_display())
    except (ImportError, OSError, RuntimeError) as reason:
        warnings.warn(f"GUI without a page, sliders and drawings are kept in software: {reason}", UserWarning, 2)


def _close(client: int) -> None:
    if (shown := _pages.pop(client, None)) is not None:
        shown.close()


def _end() -> None:
    for client in list(_pages):
        _close(client)
    pybullet_gui.end()


def _has_display() -> bool:
    """Whether a browser would have a place: not through SSH, or in a container."""
    has_windows = sys.platform in ("darwin", "win32")
    return has_windows or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
