"""Statistics of what datasets hold, as LeRobot's normalisers want them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_QUANTILES = (0.01, 0.1, 0.5, 0.9, 0.99)
Statistics = dict[str, list[Any]]


def of_rows(values: NDArray[Any]) -> Statistics:
    """Of each column of (n, k)."""
    rows = values.astype(np.float64)
    found = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
    found |= {_name(share): row for share, row in zip(_QUANTILES, np.quantile(rows, _QUANTILES, axis=0), strict=True)}
    return {name: value.tolist() for name, value in found.items()} | {"count": [len(rows)]}


def histogram(pictures: NDArray[np.uint8]) -> NDArray[np.int64]:
    """How often each value occurs in each channel of pictures (n, h, w, 3): (3, 256)."""
    channels = pictures.reshape(-1, 3).T
    return np.stack([np.bincount(channel, minlength=256) for channel in channels])


def of_histogram(counts: NDArray[np.int64], pictures: int) -> Statistics:
    """Of the channels of so many pictures, in [0, 1], each (3, 1, 1)."""
    values = np.arange(256) / 255
    share = counts / counts.sum(1, keepdims=True)
    mean = share @ values
    deviation = np.sqrt(np.maximum(share @ values**2 - mean**2, 0))
    occurs, below = counts > 0, np.cumsum(share, 1)
    found = {
        "min": values[occurs.argmax(1)],
        "max": values[255 - occurs[:, ::-1].argmax(1)],
        "mean": mean,
        "std": deviation,
        **{_name(quantile): values[(below >= quantile).argmax(1)] for quantile in _QUANTILES},
    }
    return {name: value.reshape(3, 1, 1).tolist() for name, value in found.items()} | {"count": [pictures]}


def _name(share: float) -> str:
    return f"q{round(100 * share):02d}"
