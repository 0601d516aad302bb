"""The script `manyhands`: a package of its own, so that Ctrl-C ends it without a word while `manyhands` is imported."""

import sys


def main() -> int:
    """`manyhands.cli.main`, and 130 after Ctrl-C at any time."""
    try:
        from manyhands.cli import main as run

        return run()
    except KeyboardInterrupt:
        return 130
    except ImportError as error:
        if isinstance(error.__cause__, KeyboardInterrupt):  # it struck an extension module
            return 130
        if error.name == "manyhands._core":  # there is none that runs here
            print(f"manyhands: {error}", file=sys.stderr)
            return 2
        raise
