"""The script `manyhands`: a package of its own, so that Ctrl-C ends it without a word while `manyhands` is imported."""

import sys
from types import TracebackType

INTERRUPTED = 130  # the shell's code for Ctrl-C


def main() -> int:
    """`manyhands.cli.main`, and 130 after Ctrl-C at any time."""
    try:
        from manyhands.cli import main as run

        return run()
    except (KeyboardInterrupt, ImportError) as error:
        if is_interruption(error):
            return INTERRUPTED
        if isinstance(error, ImportError) and error.name == "manyhands._core":  # there is none that runs here
            print(f"manyhands: {error}", file=sys.stderr)
            return 2
        raise


def is_interruption(error: BaseException) -> bool:
    """Whether Ctrl-C is behind it, which may have struck an extension module."""
    return isinstance(error, KeyboardInterrupt) or isinstance(error.__cause__, KeyboardInterrupt)


def end_quietly(kind: type[BaseException], error: BaseException, traceback: TracebackType | None) -> None:
    """A `sys.excepthook` for `python -m manyhands`, which imports the package before `main` is called."""
    if is_interruption(error):
        raise SystemExit(INTERRUPTED)
    sys.__excepthook__(kind, error, traceback)
