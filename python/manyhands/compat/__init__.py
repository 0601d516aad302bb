"""Old programs on this engine: `install_as` in a program, `python -m manyhands.compat PROGRAM` around one."""

from manyhands.compat.names import NAMES, install_as

__all__ = ["NAMES", "install_as"]
