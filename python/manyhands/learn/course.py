"""The course of a training: learning rates that change, and TensorBoard's events."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Protocol

from manyhands._core.learn import TrainMetrics
from manyhands.extras import needs

Schedule = Callable[[float], float]
"""A learning rate by what is left of the training, from 1 down to 0."""

_SECONDS_BETWEEN = 1.0  # of events


def rate_at(learning_rate: float | Schedule, left: float) -> float:
    """The rate where so much of the training is left. Raises ValueError unless it is a number of at least 0."""
    rate = learning_rate(left) if callable(learning_rate) else learning_rate
    try:
        number = float(rate)
    except (TypeError, ValueError) as error:
        raise ValueError(f"learning_rate is {rate!r}, expected a number, or a function that gives one") from error
    if not (math.isfinite(number) and number >= 0):
        where = _where(learning_rate, left)
        raise ValueError(f"learning_rate is {number}{where}, expected a finite number, at least 0")
    return number


def first_rate(learning_rate: float | Schedule) -> float:
    """The rate with which training begins. Raises ValueError unless it is positive."""
    rate = rate_at(learning_rate, 1.0)
    if rate == 0:
        raise ValueError(f"learning_rate is 0{_where(learning_rate, 1.0)}, expected a positive number to begin with")
    return rate


def _where(learning_rate: float | Schedule, left: float) -> str:
    return f" where {left:g} of the training is left" if callable(learning_rate) else ""


class Trained(Protocol):
    """What is told of a model."""

    @property
    def metrics(self) -> TrainMetrics: ...
    @property
    def has_success(self) -> bool: ...
    @property
    def present_rate(self) -> float: ...


class Log:
    """Writes where training stands to TensorBoard, by the names of Stable-Baselines3; nothing without a folder."""

    def __init__(self, folder: Path | None, name: str) -> None:
        """Events go to the first of folder/NAME_1, NAME_2, ... that is not there yet. Raises OSError if they cannot."""
        self._events = None
        self._last = self._begin = time.monotonic()
        self._first_step: int | None = None
        if folder is not None:
            with needs("train", "tensorboard_log"):
                from manyhands.training.events import Events
            self._events = Events(_new_folder(folder, name))

    def add(self, model: Trained, last: bool = False) -> None:
        """Writes, where the last time was a while ago or it is the last time."""
        if self._events is None:
            return
        now, metrics = time.monotonic(), model.metrics
        if self._first_step is None:
            self._first_step = metrics.env_steps
        if not last and now - self._last < _SECONDS_BETWEEN:
            return
        self._last = now
        values = {
            "rollout/ep_rew_mean": metrics.mean_return,
            "time/fps": (metrics.env_steps - self._first_step) / max(now - self._begin, 1e-9),
            "train/critic_loss": metrics.critic_loss,
            "train/entropy": metrics.entropy,
            "train/learning_rate": model.present_rate,
            "train/n_updates": metrics.gradient_steps,
        }
        if model.has_success:
            values["rollout/success_rate"] = metrics.success_rate
        self._events.add(metrics.env_steps, values)

    def __enter__(self) -> "Log":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._events is not None:
            self._events.__exit__(kind, error, traceback)


def _new_folder(folder: Path, name: str) -> Path:
    number = 1
    while (new := folder / f"{name}_{number}").exists():
        number += 1
    try:
        new.mkdir(parents=True)
    except OSError as reason:
        text = f"{new} cannot be written ({reason.strerror}); name a place where tensorboard_log can be"
        raise type(reason)(text) from reason
    return new
