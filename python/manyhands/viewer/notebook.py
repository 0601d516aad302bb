"""The page inside a notebook, or in the browser of whoever sits at the machine."""

import os
import sys
from html import escape
from typing import Any


def page_in_cell(url: str, height: int = 600) -> str:
    """HTML that shows a page below a notebook's cell."""
    return f'<iframe src="{escape(url, quote=True)}" width="100%" height="{height}" frameborder="0"></iframe>'


def is_notebook() -> bool:
    """Whether the program runs in a notebook, which shows HTML."""
    ipython: Any = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


def has_screen() -> bool:
    """Whether a browser that is opened would be seen."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def show_in_cell(viewer: Any) -> None:
    """Shows a viewer's page below the cell that runs."""
    ipython: Any = sys.modules["IPython"]
    ipython.display.display(viewer)
