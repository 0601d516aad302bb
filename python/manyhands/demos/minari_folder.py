"""Demonstrations in the layout of Minari 0.5: HDF5 and JSON, for `minari.load_dataset`.

https://minari.farama.org/content/dataset_standards
"""

import io
import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

from manyhands.demos.episodes import ROWS, Demonstrations, Episode, Source
from manyhands.envs.spaces import action_space, observation_space
from manyhands.files import replacing_folder, write_text

_MINARI_VERSION = "0.5.4"  # the first that reads pictures that are not JPEG
_DATA, _METADATA = Path("data", "main_data.hdf5"), Path("data", "metadata.json")


def write(episodes: Iterable[Episode], source: Source, path: Path, force: bool) -> None:
    """Writes the folder of a dataset. Raises ValueError if its name is none for Minari, OSError if it cannot."""
    path = path.absolute()
    if not re.fullmatch(r"[-_.\w]+-v\d+", path.name):
        raise ValueError(f"{path.name!r} is no name of a Minari dataset: end it with a version, as in expert-v0")
    with replacing_folder(path, str(_METADATA), force) as folder:
        (folder / "data").mkdir()
        count = steps = 0
        packed = io.BytesIO()  # in memory first: HDF5 does not come back from a disk that is full
        with h5py.File(packed, "w", track_order=True) as file:
            for episode in episodes:
                _add(file.create_group(f"episode_{count}"), count, episode)
                count += 1
                steps += len(episode)
        (folder / _DATA).write_bytes(packed.getbuffer())
        write_text(folder / _METADATA, json.dumps(_metadata(source, path, folder, count, steps)))


def _add(group: h5py.Group, number: int, episode: Episode) -> None:
    group.attrs.update({"id": number, "seed": episode.seed, "total_steps": len(episode)})
    ends = np.zeros(len(episode), np.bool_)
    ends[-1] = True
    observations, infos = group.create_group("observations"), group.create_group("infos")
    for name, values in episode.observations.items():
        packed: dict[str, Any] = {"compression": "gzip"} if name not in ROWS else {}
        observations.create_dataset(name, data=values, **packed)
    group.create_dataset("actions", data=episode.actions)
    group.create_dataset("rewards", data=episode.rewards)
    group.create_dataset("terminations", data=ends & episode.terminated)
    group.create_dataset("truncations", data=ends & (not episode.terminated))
    infos.create_dataset("is_success", data=episode.success)
    infos.create_dataset("intended_action", data=episode.intended)


def _metadata(source: Source, path: Path, folder: Path, count: int, steps: int) -> dict[str, Any]:
    pictures = {name: spaces.Box(0, 255, (*size, 3), np.uint8) for name, size in source.cameras.items()}
    seen, done = observation_space(source.spec, pictures), action_space(source.spec)
    group = path.parent.name
    return {
        "total_episodes": count,
        "total_steps": steps,
        "data_format": "hdf5",
        "jpeg_encoding": False,  # pictures as they were seen
        "observation_space": json.dumps(_as_json(seen)),
        "action_space": json.dumps(_as_json(done)),
        "env_spec": source.env_spec,
        "dataset_id": f"{group}/{path.name}" if re.fullmatch(r"[-_\w]+", group) else path.name,
        "algorithm_name": source.policy,
        "action_noise": source.noise,
        "minari_version": _MINARI_VERSION,
        "dataset_size": round(sum(file.stat().st_size for file in folder.glob("**/*.hdf5")) / 1e6, 1),  # [MB]
    }


def _as_json(space: spaces.Space[Any]) -> dict[str, Any]:
    """A space as Minari writes it."""
    if isinstance(space, spaces.Dict):
        return {"type": "Dict", "subspaces": {name: _as_json(one) for name, one in space.spaces.items()}}
    assert isinstance(space, spaces.Box)
    bounds = {"low": space.low.tolist(), "high": space.high.tolist()}
    return {"type": "Box", "dtype": str(space.dtype), "shape": list(space.shape), **bounds}


def read(path: Path) -> Demonstrations:
    """A dataset of Minari's whose observations have goals. Raises ValueError on anything else."""
    rows: dict[str, list[Any]] = {name: [] for name in (*ROWS, "action")}
    try:
        metadata = json.loads((path / _METADATA).read_text())
        with h5py.File(path / _DATA) as file:
            for number in range(metadata["total_episodes"]):
                group: Any = file[f"episode_{number}"]
                for name in ROWS:
                    rows[name].append(group["observations"][name][:-1])
                wanted = "infos/intended_action" if "infos/intended_action" in group else "actions"
                rows["action"].append(group[wanted][:])
        if not rows["action"]:
            raise ValueError("it has no episodes")
        env_id = EnvSpec.from_json(metadata["env_spec"]).id if "env_spec" in metadata else None
        arrays: Any = {name: np.concatenate(values).astype(np.float32) for name, values in rows.items()}
    except (KeyError, ValueError, TypeError, OSError, RuntimeError) as reason:
        raise ValueError(f"{path} is no whole dataset of Minari's with goals: {reason}") from reason
    return Demonstrations(env_id, **arrays, lengths=np.array([len(one) for one in rows["action"]], np.int64))
