"""Records the course of a training: metrics.csv and, where TensorBoard is installed, its events."""

import csv
import io
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from manyhands._core.learn import TrainMetrics
from manyhands.files import write_text
from manyhands.interrupts import held
from manyhands.training.optional import has
from manyhands.training.run_folder import RunFolder

if TYPE_CHECKING:
    from manyhands.training.events import Events

_RECENT = 100  # episodes over which the trainer averages


@dataclass(frozen=True)
class Row:
    """One line of metrics.csv."""

    iterations: int
    env_steps: int  # over all worlds
    gradient_steps: int
    episodes: int
    success_rate: float  # of the last 100 training episodes, which explore; NaN before these are the learner's own
    evaluation_success_rate: float  # of the last evaluation without noise
    evaluations: int
    critic_loss: float
    q_mean: float
    policy_q_mean: float
    env_steps_per_second: float
    seconds: float  # of training, periodic evaluations included, across resumptions


class Recorder:
    """Keeps all rows, and writes each as it comes."""

    def __init__(self, folder: RunFolder, num_envs: int, resume_at: int = 0) -> None:
        """Goes on after the rows of the first `resume_at` iterations. Raises ValueError if metrics.csv is damaged."""
        self._folder = folder
        self._num_envs = num_envs
        self.rows = [row for row in read_rows(folder) if row.iterations <= resume_at] if resume_at else []
        self._events: Events | None = None

    @property
    def seconds(self) -> float:
        """Training time of all rows."""
        return self.rows[-1].seconds if self.rows else 0.0

    def add(self, metrics: TrainMetrics, elapsed: float) -> Row:
        """Records where training stands after `elapsed` more seconds."""
        steps = metrics.env_steps - (self.rows[-1].env_steps if self.rows else 0)
        row = Row(
            iterations=metrics.iterations,
            env_steps=metrics.env_steps,
            gradient_steps=metrics.gradient_steps,
            episodes=metrics.episodes,
            success_rate=metrics.success_rate if self._are_its_own(metrics) else math.nan,
            evaluation_success_rate=metrics.evaluation_success_rate,
            evaluations=metrics.evaluations,
            critic_loss=metrics.critic_loss,
            q_mean=metrics.q_mean,
            policy_q_mean=metrics.policy_q_mean,
            env_steps_per_second=steps / max(elapsed, 1e-9),
            seconds=self.seconds + elapsed,
        )
        self.rows.append(row)
        self._write_csv()
        if self._events is None:  # not before: a run with nothing left to train gets no file
            self._events = _events(self._folder.path)
        if self._events is not None:
            self._events.add(row.env_steps, {f"train/{name}": value for name, value in asdict(row).items()})
        return row

    def _are_its_own(self, metrics: TrainMetrics) -> bool:
        """Whether the last episodes are the learner's: before it learns, the expert acts or chance, and the first that
        end are the quick ones."""
        if metrics.gradient_steps == 0:
            return False
        begin = next((row.episodes for row in self.rows if row.gradient_steps > 0), metrics.episodes)
        return metrics.episodes - begin >= max(self._num_envs, _RECENT)

    def _write_csv(self) -> None:
        text = io.StringIO()
        writer = csv.DictWriter(text, [column.name for column in fields(Row)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in self.rows)
        write_text(self._folder.metrics, text.getvalue())

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._events is not None:
            self._events.__exit__(kind, error, traceback)


def _events(folder: Path) -> "Events | None":
    if not has("tensorboard"):
        return None
    with held():
        from manyhands.training.events import Events

    return Events(folder)


def read_rows(folder: RunFolder) -> list[Row]:
    """The rows of metrics.csv, none if there is no such file. Raises ValueError with the line that is damaged."""
    if not folder.metrics.is_file():
        return []
    lines = folder.metrics.read_text(encoding="utf-8", errors="replace").splitlines()
    header = ",".join(column.name for column in fields(Row))
    if not lines or lines[0] != header:
        raise ValueError(f"{folder.metrics}:1: expected the header {header}")
    return [_read_row(line, f"{folder.metrics}:{number}") for number, line in enumerate(lines[1:], start=2)]


def _read_row(line: str, where: str) -> Row:
    columns = fields(Row)
    try:
        pairs = zip(columns, line.split(","), strict=True)
        return Row(**{column.name: column.type(text) for column, text in pairs})  # pyright: ignore[reportCallIssue]
    except ValueError as error:
        raise ValueError(
            f"{where}: expected {len(columns)} numbers, found {line!r}; "
            "mend or remove the file, the checkpoint does not need it"
        ) from error
