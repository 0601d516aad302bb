"""The folder of a training run and what lies in it."""

import json
import platform
from dataclasses import asdict, replace
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from manyhands.files import write_text
from manyhands.training.settings import FIRST_EVALUATION_SEED, TrainSettings

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

    @classmethod
    def create(cls, parent: Path, settings: TrainSettings) -> "RunFolder":
        """A new folder <environment>-<date>-<seed> in `parent`. Raises OSError if there can be none."""
        name = f"{settings.env_id}-{datetime.now():%Y%m%d-%H%M%S}-{settings.seed}"
        path = parent / name
        for again in range(2, 1000):
            try:
                path.mkdir(parents=True)
                break
            except FileExistsError:
                path = parent / f"{name}-{again}"
            except OSError as reason:
                text = f"no run can be kept in {parent} ({reason.strerror}); name another folder with --runs"
                raise type(reason)(text) from reason
        folder = cls(path)
        folder.write_config(settings)
        return folder

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
        try:
            settings = TrainSettings(**json.loads(self.config.read_text(encoding="utf-8"))["settings"])
        except json.JSONDecodeError as error:
            raise ValueError(f"{self.config}:{error.lineno}: expected JSON: {error.msg}") from error
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError(f"{self.config}: expected the settings of a run under 'settings': {error}") from error
        return replace(settings, **{name: value for name, value in changes.items() if value is not None})
