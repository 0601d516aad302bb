"""The formats in which demonstrations are kept."""

import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path

from manyhands.demos.episodes import Demonstrations, Episode, Source
from manyhands.extras import needs

FORMATS = ("minari", "lerobot", "npz")


def write(format: str, episodes: Iterable[Episode], source: Source, path: Path, force: bool = False) -> None:
    """Writes episodes as a file (npz) or a folder, whole or not at all; what is there is replaced with `force`.

    Raises ValueError on an unknown format, FileExistsError, or OSError where nothing can be written.
    """
    _writer(format)(episodes, source, path, force)


def read(path: Path) -> Demonstrations:
    """What a file or folder of any of the formats holds to learn from. Raises ValueError if it is none."""
    if not path.exists():
        raise ValueError(f"there are no demonstrations {path}: manyhands demos makes some")
    with needs("demos", f"reading {path}"):
        if (path / "meta" / "info.json").is_file():
            from manyhands.demos.lerobot_folder import read as read_lerobot

            return read_lerobot(path)
        if (path / "data" / "metadata.json").is_file():
            from manyhands.demos.minari_folder import read as read_minari

            return read_minari(path)
    if path.is_file() and zipfile.is_zipfile(path):
        from manyhands.demos.npz_file import read as read_npz

        return read_npz(path)
    raise ValueError(f"{path} holds no demonstrations: expected a folder of Minari's or LeRobot's, or a file .npz")


def _writer(format: str) -> Callable[[Iterable[Episode], Source, Path, bool], None]:
    with needs("demos", f"the format {format}"):
        if format == "minari":
            from manyhands.demos.minari_folder import write
        elif format == "lerobot":
            from manyhands.demos.lerobot_folder import write
        elif format == "npz":
            from manyhands.demos.npz_file import write
        else:
            raise ValueError(f"there is no format {format!r}, expected one of {', '.join(FORMATS)}")
    return write
