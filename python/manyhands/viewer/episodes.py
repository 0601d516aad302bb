"""Episodes that somebody acted, as files."""

import time
from pathlib import Path
from typing import Any

import numpy as np

from manyhands.files import replacing
from manyhands.viewer.environments import EnvSource, Outcome


class EpisodeWriter:
    """Writes each episode of an environment to a file of its own: numpy's .npz.

    `observation`, `achieved_goal`, `desired_goal` (n + 1 rows: before the first step and after each), `action`,
    `reward`, `success` (n rows), `dt` [s] and `env_id`.
    """

    def __init__(self, source: EnvSource, folder: Path = Path("episodes")) -> None:
        self._source, self._folder = source, folder
        self._rows: list[tuple[Any, Outcome]] = []
        self._first: Outcome | None = None
        self.is_writing = False
        self.where: Path | None = None
        """The last file that was written, or the folder."""
        source.on_step.append(self._step)
        source.on_reset.append(self._begin)

    def start(self) -> None:
        """From the present state on."""
        self.is_writing, self.where = True, self._folder
        self._rows, self._first = [], self._source.outcome

    def stop(self) -> None:
        self._write()
        self.is_writing = False

    def _begin(self, outcome: Outcome) -> None:
        if self.is_writing:
            self._write()
            self._rows, self._first = [], outcome

    def _step(self, action: Any, outcome: Outcome) -> None:
        if not self.is_writing:
            return
        # After a rewind the episode goes on from an earlier step.
        while self._rows and self._rows[-1][1].length >= outcome.length:
            self._rows.pop()
        self._rows.append((action, outcome))

    def _write(self) -> None:
        if not self._rows or self._first is None:
            return
        outcomes = [outcome for _, outcome in self._rows]
        seen = [self._first.observation, *(outcome.observation for outcome in outcomes)]
        arrays: dict[str, Any] = {key: np.array([each[key] for each in seen]) for key in seen[0]}
        self._folder.mkdir(parents=True, exist_ok=True)
        stamp = time.strftime("%Y%m%d-%H%M%S")
        name = f"{self._source.env_id}-{stamp}".replace("/", "-")
        path, number = self._folder / f"{name}.npz", 1
        while path.exists():
            number += 1
            path = self._folder / f"{name}-{number}.npz"
        with replacing(path) as temporary:
            np.savez_compressed(
                temporary, **arrays, action=np.array([action for action, _ in self._rows]),
                reward=np.array([outcome.reward for outcome in outcomes]),
                success=np.array([outcome.success for outcome in outcomes]),
                dt=self._source.dt, env_id=self._source.env_id,
            )  # fmt: skip
        self.where = path
        self._rows = []
