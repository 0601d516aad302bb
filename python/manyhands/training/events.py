"""TensorBoard's events of a run."""

import threading
import time
from collections.abc import Mapping
from pathlib import Path

from tensorboard.compat.proto.event_pb2 import Event  # pyright: ignore[reportAttributeAccessIssue]
from tensorboard.compat.proto.summary_pb2 import Summary  # pyright: ignore[reportAttributeAccessIssue]
from tensorboard.summary.writer.event_file_writer import EventFileWriter

from manyhands.files import naming


class Events:
    """A file of events in a folder."""

    def __init__(self, folder: Path) -> None:
        self._name = folder / "events"
        self._hook = threading.excepthook
        threading.excepthook = self._hear
        with naming(self._name):
            self._writer = EventFileWriter(str(folder))

    def add(self, values: Mapping[str, float], step: int) -> None:
        """One value under each name."""
        summaries = [Summary.Value(tag=f"train/{name}", simple_value=value) for name, value in values.items()]
        with naming(self._name):
            self._writer.add_event(Event(wall_time=time.time(), step=step, summary=Summary(value=summaries)))

    def close(self) -> None:
        """Writes what is left. Raises OSError if it cannot."""
        try:
            with naming(self._name):
                self._writer.close()
        finally:
            threading.excepthook = self._hook

    def _hear(self, unheard: threading.ExceptHookArgs) -> None:
        """What stops TensorBoard's thread is raised again where the next event is added, and need not be told twice."""
        if not type(unheard.thread).__module__.startswith("tensorboard."):
            self._hook(unheard)
