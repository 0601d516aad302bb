"""Files of the tasks: pictures that bodies wear."""

from pathlib import Path


def get_data_path() -> str:
    """The folder that holds them."""
    return str(Path(__file__).parent)
