"""Scenes that planners and grasps look at: a world as it is now, or a model with its configuration."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, World
from manyhands.arguments import finite_row

Array = NDArray[np.float64]


def state_of(scene: World | Model, q: ArrayLike | None) -> tuple[Model, Array, Array]:
    """The model, its q (nq,), by default the initial one, and the poses of its mocap bodies; empty for where the model
    has them. Raises TypeError on anything else."""
    if isinstance(scene, World):
        if q is not None:
            raise ValueError("a world has a q of its own; set world.q, or give its model")
        return scene.model, np.asarray(scene.q), np.asarray(scene.mocap, np.float64).reshape(-1)
    if not isinstance(scene, Model):
        raise TypeError(
            f"scene is of type {type(scene).__name__}; expected a World or a Model (World.from_file reads a file)"
        )
    row = finite_row("q", scene.initial_configuration() if q is None else q, scene.nq)
    return scene, np.ascontiguousarray(row), np.zeros(0)


def names(given: Iterable[str]) -> list[str]:
    """Names as a list; a text is one name."""
    return [given] if isinstance(given, str) else list(given)
