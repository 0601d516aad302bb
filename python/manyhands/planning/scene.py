"""Scenes that planners and grasps look at: a world as it is now, or a model with its configuration."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, World
from manyhands.arguments import finite_row, instance, listed

Array = NDArray[np.float64]


def state_of(scene: World | Model, q: ArrayLike | None) -> tuple[Model, Array, Array]:
    """The model, its q (nq,), by default the initial one, and the poses of its mocap bodies; empty for where the model
    has them. Raises TypeError on anything else."""
    if isinstance(scene, World):
        if q is not None:
            raise ValueError("a world has a q of its own; set world.q, or give its model")
        return scene.model, np.asarray(scene.q), np.asarray(scene.mocap, np.float64).reshape(-1)
    model = instance("scene", scene, Model, hint="or a World; World.from_file reads a file")
    row = finite_row("q", model.initial_configuration() if q is None else q, model.nq)
    return model, np.ascontiguousarray(row), np.zeros(0)


def names(argument: str, given: Iterable[str]) -> list[str]:
    """Names as a list; a text is one name. Raises TypeError on anything else."""
    return [given] if isinstance(given, str) else listed(argument, given, str)
