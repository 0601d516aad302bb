"""The wrappers that programs use most; those that are not here are missed with a word on what to do."""

from typing import Any

from manyhands.gym.wrappers.common import (
    ClipAction,
    FilterObservation,
    FlattenObservation,
    RecordEpisodeStatistics,
    RescaleAction,
    TransformObservation,
    TransformReward,
)
from manyhands.gym.wrappers.time_limit import TimeLimit

__all__ = [
    "ClipAction",
    "FilterObservation",
    "FlattenObservation",
    "RecordEpisodeStatistics",
    "RescaleAction",
    "TimeLimit",
    "TransformObservation",
    "TransformReward",
]


def __getattr__(name: str) -> Any:
    if name.startswith("_"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    hint = "Gymnasium's wrappers take its own environments, and `manyhands record` writes videos"
    raise AttributeError(f"the old gym's wrapper {name!r} is not here; there are {', '.join(__all__)}. {hint}")
