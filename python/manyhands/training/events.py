"""TensorBoard's event files."""

import threading
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType

from tensorboard.compat.proto.event_pb2 import Event  # pyright: ignore[reportAttributeAccessIssue]
from tensorboard.compat.proto.summary_pb2 import Summary  # pyright: ignore[reportAttributeAccessIssue]
from tensorboard.summary.writer.event_file_writer import EventFileWriter

from manyhands.files import naming


class Events:
    """Numbers by name and step, in a file of a folder."""

    def __init__(self, folder: Path) -> None:
        """Raises OSError if nothing can be written to the folder."""
        self._named = folder / "events"
        self._hook = threading.excepthook
        threading.excepthook = self._hear
        with naming(self._named):
            self._writer = EventFileWriter(str(folder))

    def add(self, step: int, values: Mapping[str, float]) -> None:
        """Writes values of a step. Raises OSError if earlier ones could not be written."""
        summary = Summary(value=[Summary.Value(tag=tag, simple_value=value) for tag, value in values.items()])
        with naming(self._named):
            self._writer.add_event(Event(wall_time=time.time(), step=step, summary=summary))

    def _hear(self, unheard: threading.ExceptHookArgs) -> None:
        """What stops TensorBoard's thread is raised again where the next event is added, and need not be told twice."""
        if not type(unheard.thread).__module__.startswith("tensorboard."):
            self._hook(unheard)

    def __enter__(self) -> "Events":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        try:
            with naming(self._named):
                self._writer.close()
        finally:
            threading.excepthook = self._hook
