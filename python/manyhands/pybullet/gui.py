"""Windows: a client that is connected with GUI is shown by a page in the browser."""

import atexit
import os
from typing import TYPE_CHECKING

from manyhands._core import pybullet_gui
from manyhands._core.pybullet import error

if TYPE_CHECKING:
    from manyhands.pybullet.page import Page

SWITCH = "MANYHANDS_PYBULLET_GUI"
"""The environment variable that says what a window is. 0: nothing to be seen, all is kept in software; page: a page, to
be opened by hand; else a page, which the browser opens where there is a screen."""

_pages: "dict[int, Page]" = {}


def page(client: int) -> "Page | None":
    """The page of a client; None of one that has none."""
    return _pages.get(client)


def listen() -> None:
    """Opens a page with each window from now on."""
    pybullet_gui.listen(_open, _close)
    atexit.register(_end)


def _open(client: int) -> None:
    wanted = os.environ.get(SWITCH, "")
    if wanted == "0":
        return
    try:
        from manyhands.pybullet.page import Page

        _pages[client] = Page(client, opens=wanted != "page")
    except (ImportError, OSError, RuntimeError) as reason:
        raise error(f"connect(GUI): {reason}; or connect with DIRECT, or set {SWITCH}=0") from reason


def _close(client: int) -> None:
    if (shown := _pages.pop(client, None)) is not None:
        shown.close()


def _end() -> None:
    for client in list(_pages):
        _close(client)
    pybullet_gui.end()
