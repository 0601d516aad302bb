"""Demonstrations as one file of numpy's."""

import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from manyhands.demos.episodes import ROWS, Demonstrations, Episode, Source
from manyhands.files import replacing, require_new


def write(episodes: Iterable[Episode], source: Source, path: Path, force: bool) -> None:
    """Writes arrays of all steps, one episode after the other: `lengths` (episodes) says how many each has.

    Observations have a row more for each episode: what was seen last.
    """
    require_new(path, force)
    with replacing(path.absolute()) as temporary:
        found = list(episodes)
        arrays: dict[str, Any] = {
            **{name: np.concatenate([one.observations[name] for one in found]) for name in found[0].observations},
            "action": np.concatenate([one.actions for one in found]),
            "intended_action": np.concatenate([one.intended for one in found]),
            "reward": np.concatenate([one.rewards for one in found]),
            "is_success": np.concatenate([one.success for one in found]),
            "lengths": np.array([len(one) for one in found], np.int64),
            "seeds": np.array([one.seed for one in found], np.uint64),
            "terminated": np.array([one.terminated for one in found]),
            "env_id": np.array(source.env_id),
            "policy": np.array(source.policy),
            "noise": np.array(source.noise),
        }
        with temporary.open("wb") as file:
            np.savez_compressed(file, **arrays)


def read(path: Path) -> Demonstrations:
    """What `write` wrote. Raises ValueError on anything else."""
    try:
        with np.load(path, allow_pickle=False) as file:
            lengths = file["lengths"]
            last = np.cumsum(lengths + 1) - 1
            rows = {name: np.delete(file[name], last, axis=0) for name in ROWS}
            return Demonstrations(str(file["env_id"]), **rows, action=file["intended_action"], lengths=lengths)
    # zipfile says RuntimeError of what it takes for a password, or for a version to come.
    except (LookupError, ValueError, OSError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error) as reason:
        raise ValueError(f"{path} is no whole file of demonstrations: {reason}") from reason
