"""The folder of a training run and what lies in it."""

import errno
import json
import os
import platform
import shutil
from collections.abc import Callable
from dataclasses import asdict, replace
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any, TypeVar

from manyhands.files import write_text
from manyhands.training.settings import FIRST_EVALUATION_SEED, TrainSettings

_T = TypeVar("_T")

_VERSIONS_OF = ("manyhands", "numpy", "gymnasium", "onnx", "matplotlib", "tensorboard")


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "unknown"


class RunFolder:
    """Names the files of a run; makes and reads its config."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.config = path / "config.json"
        self.metrics = path / "metrics.csv"
        self.checkpoint = path / "checkpoint.bin"
        self.policy = path / "policy.onnx"
        self.evaluation = path / "evaluation.json"
        self.curve = path / "learning_curve.png"
        self.randomization = path / "randomization.png"
        self.log = path / "log.txt"  # of a run in a sweep: what it printed

    @classmethod
    def create(cls, parent: Path, settings: TrainSettings, save: Callable[[Path], None]) -> "RunFolder":
        """A new folder <environment>-<date>-<seed> in `parent`, which appears whole, with its config and what `save`
        writes as the first checkpoint. Raises OSError if there can be none."""
        name = f"{settings.env_id}-{datetime.now():%Y%m%d-%H%M%S}-{settings.seed}"
        begun = cls(parent / f".{name}.{os.getpid()}")
        try:
            begun.path.mkdir(parents=True)
        except OSError as reason:
            text = f"no run can be kept in {parent} ({reason.strerror}); name another folder with --runs"
            raise type(reason)(text) from reason
        try:
            begun.write_config(settings)
            save(begun.checkpoint)
            return cls(_renamed(begun.path, parent / name))
        finally:
            shutil.rmtree(begun.path, ignore_errors=True)

    def make(self, settings: TrainSettings) -> None:
        """Makes this very folder, unless it is there, and writes its config. Raises OSError if it cannot."""
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as reason:
            text = f"no run can be kept in {self.path.parent} ({reason.strerror}); name another folder with --out"
            raise type(reason)(text) from reason
        self.write_config(settings)

    def clear_drafts(self) -> None:
        """Removes what a run that was killed had begun to write. To be called by who has locked the folder."""
        for file in (self.checkpoint, self.metrics, self.config, self.policy, self.evaluation, self.curve):
            for draft in (*self.path.glob(f".{file.stem}.*{file.suffix}"), *self.path.glob(f"{file.name}.part*")):
                draft.unlink(missing_ok=True)

    def write_config(self, settings: TrainSettings) -> None:
        """Writes config.json: the settings, what follows from them, and the versions at work."""
        last_seed = FIRST_EVALUATION_SEED + settings.evaluation_episodes - 1
        config = {
            "settings": asdict(settings),
            "trainer": settings.trainer_config().to_dict(),
            "seeds": {"training": settings.seed, "evaluation": [FIRST_EVALUATION_SEED, last_seed]},
            "versions": {"python": platform.python_version()} | {name: _version(name) for name in _VERSIONS_OF},
            "platform": platform.platform(),
            "written": datetime.now().astimezone().isoformat(timespec="seconds"),
        }
        write_text(self.config, json.dumps(config, indent=2) + "\n")

    def read_settings(self, **changes: Any) -> TrainSettings:
        """The settings in config.json, with `changes` that are not None. Raises ValueError if there are none."""
        if not self.config.is_file():
            raise ValueError(f"{self.path} is no run folder: it has no {self.config.name}")
        config = _read_json(self.config)
        try:
            settings = TrainSettings(**config["settings"])
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{self.config}: expected the settings of a run under 'settings': {error}") from error
        return replace(settings, **{name: value for name, value in changes.items() if value is not None})

    def read_trainer(self) -> dict[str, Any]:
        """All settings with which the trainer ran, from config.json. Raises ValueError if there are none."""
        return _read_entry(self.config, "trainer", dict)

    def read_success(self) -> float | None:
        """Success after training, from evaluation.json; None before it. Raises ValueError if the file is damaged."""
        return _read_entry(self.evaluation, "success_rate", float) if self.evaluation.is_file() else None


def _renamed(folder: Path, wanted: Path) -> Path:
    """Where the folder is then: `wanted`, or with -2, -3 and so on behind it if that is taken."""
    place, again = wanted, 1
    while True:
        try:
            return folder.rename(place)
        except OSError as reason:
            if reason.errno not in (errno.EEXIST, errno.ENOTEMPTY, errno.ENOTDIR):
                raise
        again += 1
        place = wanted.with_name(f"{wanted.name}-{again}")


def _read_json(path: Path) -> Any:
    """What a file holds. Raises ValueError with the line that is damaged."""
    try:
        return json.loads(path.read_text(encoding="utf-8", errors="replace"))
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}:{error.lineno}: expected JSON: {error.msg}") from error


def _read_entry(path: Path, name: str, kind: type[_T]) -> _T:
    """One of the values in a file by their names. Raises ValueError unless it is of this kind."""
    found = _read_json(path)
    value = found.get(name) if isinstance(found, dict) else None
    if not isinstance(value, kind):
        raise ValueError(f"{path}: expected {kind.__name__} under {name!r}, found {value!r}")
    return value
