"""Policies that do what demonstrations show: regression of the demonstrated actions on what was observed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import EnvSpec
from manyhands._core.learn import Regression
from manyhands.demos.episodes import Demonstrations

_CLIP = 5.0  # standard deviations of an input, beyond which it is cut off
_LEAST_DEVIATION = 1e-2  # what hardly moves is noise, and is not blown up beyond this
_PIECE = 250  # steps between two looks at the progress


@dataclass(frozen=True)
class CloningSettings:
    """How to learn from demonstrations."""

    chunk: int = 1
    """Actions that are predicted at a time."""
    steps: int = 20_000
    """Gradient steps."""
    hidden_layers: Sequence[int] = (256, 256)
    batch_size: int = 256
    learning_rate: float = 1e-3
    seed: int = 0


@dataclass(frozen=True)
class ClonedPolicy:
    """The policy as arrays, as `Policy` of the trainer has them; the last layer gives `chunk` actions at a time."""

    observation_dim: int
    goal_dim: int
    action_dim: int
    chunk: int
    mean: NDArray[np.float32]
    scale: NDArray[np.float32]
    layers: list[tuple[NDArray[np.float32], NDArray[np.float32]]]
    clip: float = _CLIP
    differences: Sequence[int] = ()
    activation: str = "relu"
    output: str = "tanh"


def clone(
    shown: Demonstrations,
    spec: EnvSpec,
    settings: CloningSettings,
    num_threads: int,
    progress: Callable[[int, float], None] = lambda step, loss: None,
) -> ClonedPolicy:
    """Learns from demonstrations that fit the environment; `progress(steps done, mean loss)` is called now and then.

    The result depends on the demonstrations and settings, not on the threads. Raises ValueError on settings that make
    no sense, or with which learning diverges.
    """
    goals = [shown.desired_goal, shown.desired_goal - shown.achieved_goal]
    x = np.hstack([shown.observation, *goals]).astype(np.float64)
    mean, scale = x.mean(0), 1 / np.maximum(x.std(0), _LEAST_DEVIATION)
    inputs = np.clip((x - mean) * scale, -_CLIP, _CLIP).astype(np.float32)
    regression = Regression(
        inputs,
        chunks(shown.action, shown.lengths, settings.chunk),
        seed=settings.seed,
        num_threads=num_threads,
        hidden_layers=list(settings.hidden_layers),
        batch_size=settings.batch_size,
        learning_rate=settings.learning_rate,
    )
    for done in range(0, settings.steps, _PIECE):
        piece = min(_PIECE, settings.steps - done)
        try:
            loss = regression.advance(piece)
        except RuntimeError as diverged:
            raise ValueError(str(diverged)) from diverged
        progress(done + piece, loss)
    return ClonedPolicy(
        spec.observation_dim,
        spec.goal_dim,
        spec.action_dim,
        settings.chunk,
        mean.astype(np.float32),
        scale.astype(np.float32),
        regression.layers,
    )


def chunks(actions: NDArray[np.float32], lengths: NDArray[np.int64], chunk: int) -> NDArray[np.float32]:
    """(N, chunk * action_dim): the actions from each step on, NaN where its episode has ended."""
    steps = len(actions)
    left = np.concatenate([np.arange(length, 0, -1) for length in lengths])  # in the episode, this step included
    found = np.full((steps, chunk, actions.shape[1]), np.nan, np.float32)
    for ahead in range(chunk):
        (here,) = np.nonzero(left > ahead)
        found[here, ahead] = actions[here + ahead]
    return found.reshape(steps, -1)
