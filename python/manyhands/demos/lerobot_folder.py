"""Demonstrations in the layout of LeRobot v3.0: Parquet and JSON, for `LeRobotDataset`.

https://huggingface.co/docs/lerobot/lerobot-dataset-v3

LeRobot's policies see `observation.state` and `observation.environment_state`: the observation, and the achieved and
desired goals. What is seen after the last step is not kept there. Pictures are PNG in the tables, as they were seen.
"""

import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from PIL import Image

from manyhands.demos.episodes import Demonstrations, Episode, Source
from manyhands.demos.statistics import Statistics, histogram, of_histogram, of_rows
from manyhands.files import replacing_folder, write_text

_VERSION = "v3.0"
_FILES_IN_CHUNK, _DATA_BYTES = 1000, 100 * 2**20  # LeRobot's own
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_EPISODES = "meta/episodes/chunk-000/file-000.parquet"
_INFO, _OURS = "meta/info.json", "meta/manyhands.json"
_TASKS = {
    "PandaReach": "Move the hand to the target.",
    "PandaPush": "Push the cube to the target.",
    "PandaSlide": "Slide the puck to the target.",
    "PandaPickAndPlace": "Pick the cube up and take it to the target.",
    "PandaStack": "Stack the two cubes at the target.",
    "PandaFlip": "Turn the cube to the target orientation.",
}
_Table = dict[str, NDArray[Any]]  # columns of an episode's frames


def write(episodes: Iterable[Episode], source: Source, path: Path, force: bool) -> None:
    """Writes the folder of a dataset. Raises OSError if it cannot, ValueError if frames do not come a whole number of
    times a second."""
    fps = round(1 / source.spec.dt)
    if abs(fps * source.spec.dt - 1) > 1e-6:
        raise ValueError(
            f"LeRobot wants a whole number of frames a second, and a step of {source.env_id} takes "
            f"{source.spec.dt:g} s: set n_substeps and time_step so that it has one, or take another format"
        )
    with replacing_folder(path, _INFO, force) as folder:
        features = _features(source)
        writer = _Frames(folder, source, fps, features)
        try:
            for episode in episodes:
                writer.add(episode)
        finally:
            writer.close()
        pq.write_table(pa.Table.from_pylist(writer.episodes), _made(folder / _EPISODES))
        _write_tasks(folder, _task(source.env_id))
        write_text(folder / "meta/stats.json", json.dumps(writer.statistics(), indent=2))
        robot = json.loads(source.env_spec)["kwargs"].get("robot", "panda")
        write_text(folder / _INFO, json.dumps(_info(writer, robot, fps, features), indent=2))
        ours = {"env_id": source.env_id, "policy": source.policy, "action_noise": source.noise, "seed": source.seed}
        write_text(folder / _OURS, json.dumps(ours, indent=2))


class _Frames:
    """The frames of all episodes: files of bounded size, a row group for each episode."""

    def __init__(self, folder: Path, source: Source, fps: int, features: dict[str, Any]) -> None:
        self.episodes: list[dict[str, Any]] = []
        self.frames = 0
        self._folder, self._fps, self._task = folder, fps, _task(source.env_id)
        self._cameras = source.cameras
        self._schema = pa.schema([_field(name, feature) for name, feature in features.items()])
        self._file = -1
        self._writer: pq.ParquetWriter | None = None
        self._rows: dict[str, list[NDArray[Any]]] = {}
        self._histograms = {name: np.zeros((3, 256), np.int64) for name in source.cameras}

    def add(self, episode: Episode) -> None:
        """An episode after the others."""
        table, number, n = self._columns(episode), len(self.episodes), len(episode)
        found: dict[str, Statistics] = {name: of_rows(_as_rows(column)) for name, column in table.items()}
        arrays = [_as_arrow(column, self._schema.field(name).type) for name, column in table.items()]
        for camera in self._cameras:
            pictures: Any = episode.observations[camera][:-1]
            counts = histogram(pictures)
            self._histograms[camera] += counts
            found[_picture(camera)] = of_histogram(counts, n)
            packed = [{"bytes": _png(picture), "path": None} for picture in pictures]
            arrays.append(pa.array(packed, self._schema.field(_picture(camera)).type))
        writer = self._open()
        writer.write_table(pa.Table.from_arrays(arrays, schema=self._schema))
        for name, column in table.items():
            self._rows.setdefault(name, []).append(column)
        chunk, file = divmod(self._file, _FILES_IN_CHUNK)
        self.episodes.append(
            {
                "episode_index": number,
                "tasks": [self._task],
                "length": n,
                "data/chunk_index": chunk,
                "data/file_index": file,
                "dataset_from_index": self.frames,
                "dataset_to_index": self.frames + n,
                "meta/episodes/chunk_index": 0,
                "meta/episodes/file_index": 0,
                **{f"stats/{name}/{key}": value for name, one in found.items() for key, value in one.items()},
            }
        )
        self.frames += n

    def statistics(self) -> dict[str, Statistics]:
        """Over all episodes."""
        rows = {name: of_rows(_as_rows(np.concatenate(columns))) for name, columns in self._rows.items()}
        return rows | {_picture(name): of_histogram(one, self.frames) for name, one in self._histograms.items()}

    def close(self) -> None:
        """Ends the last file."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def _columns(self, episode: Episode) -> _Table:
        n = len(episode)
        seen = {name: values[:-1] for name, values in episode.observations.items()}
        frame = np.arange(n)
        ends = frame == n - 1
        return {
            "observation.state": seen["observation"],
            "observation.environment_state": np.hstack([seen["achieved_goal"], seen["desired_goal"]]),
            "action": episode.actions,
            "intended_action": episode.intended,
            "next.reward": episode.rewards.astype(np.float32),
            "next.done": ends,
            "next.success": episode.success,
            "timestamp": (frame / self._fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(n, len(self.episodes)),
            "index": self.frames + frame,
            "task_index": np.zeros(n, np.int64),
        }

    def _open(self) -> pq.ParquetWriter:
        """The file to write to: a new one if the last is full."""
        if self._writer is not None and Path(self._writer.where).stat().st_size >= _DATA_BYTES:
            self.close()
        if self._writer is None:
            self._file += 1
            chunk, file = divmod(self._file, _FILES_IN_CHUNK)
            path = _made(self._folder / _DATA.format(chunk_index=chunk, file_index=file))
            self._writer = pq.ParquetWriter(str(path), self._schema)
        return self._writer


def _features(source: Source) -> dict[str, Any]:
    """What a frame holds, in the order of its columns."""
    spec = source.spec
    goals = [f"{kind}_goal_{i}" for kind in ("achieved", "desired") for i in range(spec.goal_dim)]
    actions = [f"action_{i}" for i in range(spec.action_dim)]

    def feature(dtype: str, size: int = 1, names: list[str] | None = None) -> dict[str, Any]:
        return {"dtype": dtype, "shape": [size], "names": names}

    state = [f"observation_{i}" for i in range(spec.observation_dim)]
    found = {
        "observation.state": feature("float32", spec.observation_dim, state),
        "observation.environment_state": feature("float32", 2 * spec.goal_dim, goals),
        "action": feature("float32", spec.action_dim, actions),
        "intended_action": feature("float32", spec.action_dim, actions),
        "next.reward": feature("float32"),
        "next.done": feature("bool"),
        "next.success": feature("bool"),
        "timestamp": feature("float32"),
        **{name: feature("int64") for name in ("frame_index", "episode_index", "index", "task_index")},
    }
    for camera, size in source.cameras.items():
        found[_picture(camera)] = {"dtype": "image", "shape": [*size, 3], "names": ["height", "width", "channels"]}
    return found


def _info(writer: _Frames, robot: str, fps: int, features: dict[str, Any]) -> dict[str, Any]:
    return {
        "codebase_version": _VERSION,
        "robot_type": robot,
        "total_episodes": len(writer.episodes),
        "total_frames": writer.frames,
        "total_tasks": 1,
        "chunks_size": _FILES_IN_CHUNK,
        "data_files_size_in_mb": _DATA_BYTES // 2**20,
        "video_files_size_in_mb": 500,
        "fps": fps,
        "splits": {"train": f"0:{len(writer.episodes)}"},
        "data_path": _DATA,
        "video_path": None,
        "features": features,
    }


def _write_tasks(folder: Path, task: str) -> None:
    """A table that pandas reads with the task as its index."""
    text, number = ({"name": name, "field_name": name, "metadata": None} for name in ("task", "task_index"))
    pandas = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [
            {**number, "pandas_type": "int64", "numpy_type": "int64"},
            {**text, "pandas_type": "unicode", "numpy_type": "object"},
        ],
        "pandas_version": "2.0.0",
    }
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": [task]})
    pq.write_table(table.replace_schema_metadata({"pandas": json.dumps(pandas)}), folder / "meta/tasks.parquet")


def _task(env_id: str) -> str:
    return next((text for name, text in _TASKS.items() if env_id.startswith(name)), env_id)


def _picture(camera: str) -> str:
    return f"observation.images.{camera}"


def _png(picture: NDArray[np.uint8]) -> bytes:
    packed = io.BytesIO()
    Image.fromarray(picture).save(packed, "PNG", compress_level=1)
    return packed.getvalue()


def _field(name: str, feature: dict[str, Any]) -> pa.Field:
    if feature["dtype"] == "image":
        return pa.field(name, pa.struct({"bytes": pa.binary(), "path": pa.string()}))
    kind = pa.bool_() if feature["dtype"] == "bool" else pa.type_for_alias(feature["dtype"])
    (size,) = feature["shape"]
    return pa.field(name, kind if feature["names"] is None else pa.list_(kind, size))


def _as_arrow(column: NDArray[Any], kind: pa.DataType) -> pa.Array:
    if column.ndim == 1:
        return pa.array(column, kind)
    return pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(column).reshape(-1)), type=kind)


def _as_rows(column: NDArray[Any]) -> NDArray[Any]:
    return column.reshape(len(column), -1)


def _made(path: Path) -> Path:
    """The path, in a folder that is there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def read(path: Path) -> Demonstrations:
    """A dataset whose `observation.environment_state` holds achieved and desired goals. Raises ValueError on others."""
    try:
        info = json.loads((path / _INFO).read_text())
        if info["codebase_version"] != _VERSION:
            raise ValueError(f"it is of LeRobot {info['codebase_version']}, expected {_VERSION}")
        wanted = "intended_action" if "intended_action" in info["features"] else "action"
        names = ["observation.state", "observation.environment_state", wanted, "episode_index"]
        files = sorted(path.glob("data/*/*.parquet"))
        table = pa.concat_tables([pq.read_table(file, columns=names) for file in files])
        state, goals, action = (_matrix(table.column(name)) for name in names[:3])
        episode = table.column("episode_index").to_numpy()
        if table.num_rows != info["total_frames"]:
            raise ValueError(f"{table.num_rows} frames are there, expected {info['total_frames']}")
        ours = path / _OURS
        env_id = json.loads(ours.read_text())["env_id"] if ours.is_file() else None
    except (KeyError, ValueError, TypeError, OSError, pa.ArrowException) as reason:
        said = " ".join(f"{reason}".split())  # pyarrow takes several lines
        raise ValueError(f"{path} is no whole dataset of LeRobot's with goals: {said}") from reason
    achieved, desired = np.split(goals, [goals.shape[1] // 2], axis=1)
    return Demonstrations(env_id, state, achieved, desired, action, np.unique(episode, return_counts=True)[1])


def _matrix(column: pa.ChunkedArray) -> NDArray[np.float32]:
    rows = column.combine_chunks()
    return rows.flatten().to_numpy(zero_copy_only=False).astype(np.float32).reshape(len(rows), -1)
