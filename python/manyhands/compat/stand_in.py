"""What a file does that only stands at a name for one of our modules."""

import sys
from importlib import import_module

from manyhands.compat.names import NAMES, redirect


def take_place(name: str) -> None:
    """Puts our module in the place of the one that is being imported as `name`."""
    redirect(name)
    sys.modules[name] = import_module(NAMES[name])
