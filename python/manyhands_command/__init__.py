"""The script `manyhands`: a package of its own, so that Ctrl-C ends it without a word while `manyhands` is imported."""


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
        raise
