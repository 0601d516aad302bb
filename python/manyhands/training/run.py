"""A training run from the first step to the files it leaves."""

import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from manyhands._core.envs import make_adviser, make_env_batch
from manyhands._core.learn import Trainer, TrainMetrics
from manyhands.envs.cameras import eyes
from manyhands.files import write_text
from manyhands.interrupts import Interrupts, held
from manyhands.policies import Policy
from manyhands.training.console import Console
from manyhands.training.evaluation import Evaluation
from manyhands.training.optional import has
from manyhands.training.progress import TrainingProgress
from manyhands.training.randomization import run_randomized
from manyhands.training.recipe import expected
from manyhands.training.recorder import Recorder
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import FIRST_EVALUATION_SEED, TrainSettings, shares_of

if TYPE_CHECKING:
    from manyhands.training.cluster import Workers

_SECONDS_PER_PIECE = (0.05, 1.0)  # of training between two looks at it: shortest and longest
_SHARE_PER_PIECE = 0.01  # of the training so far, between these
_SECONDS_PER_CHECKPOINT = (3.0, 30.0)  # the first, and all after it; between them a third of the training so far


@dataclass(frozen=True)
class Outcome:
    """What became of a run. `evaluation` is None if it was interrupted."""

    solved: bool
    env_steps: int
    training_seconds: float  # periodic evaluations included, across resumptions
    evaluation_seconds: float
    waited_seconds: float  # of those of training, for workers of a cluster, since the last resumption
    evaluation: Evaluation | None


class TrainingRun:
    """A trainer with its worlds, ready to go, which writes into a folder as it goes."""

    def __init__(self, settings: TrainSettings, checkpoint: Path | None = None) -> None:
        """Goes on from the checkpoint if one is given. Raises ValueError if there is no such file, MemoryError."""
        self.settings = settings
        config = settings.trainer_config()
        threads = settings.num_threads or 0
        worlds_here = settings.num_envs if settings.workers is None else 1
        given: Any = {"num_threads": threads, "randomize": settings.ranges}
        self._envs = make_env_batch(settings.env_id, worlds_here, **given)
        self._evaluation = make_env_batch(settings.env_id, config.evaluation_episodes, **given)
        expert = make_adviser(settings.env_id) if config.wants_expert else None
        self._trainer = Trainer(self._envs, self._evaluation, config, expert, eyes(self._envs, settings.cameras))
        if settings.workers is not None:
            self._trainer.spread(shares_of(settings.num_envs, settings.workers))
        self._workers: Workers | None = None
        if checkpoint is not None:
            if not checkpoint.is_file():
                raise ValueError(f"{checkpoint.parent} has no checkpoint to resume from; start again with a new run")
            self._trainer.load(checkpoint)

    @property
    def metrics(self) -> TrainMetrics:
        """Where training stands."""
        return self._trainer.metrics()

    @property
    def iterations_left(self) -> int:
        """Until the step limit; none if the task is solved."""
        metrics = self.metrics
        if metrics.solved:
            return 0
        return max(0, math.ceil((self.settings.max_env_steps - metrics.env_steps) / self.settings.num_envs))

    def save(self, checkpoint: Path) -> None:
        """Writes the file from which training goes on. Raises OSError if it cannot be written."""
        self._trainer.save(checkpoint)

    def train(self, folder: RunFolder, console: Console) -> Outcome:
        """Trains until solved, at the step limit, or interrupted; then evaluates, unless interrupted."""
        folder.clear_drafts()
        with Recorder(folder, self.settings.num_envs, self.metrics.iterations) as recorder:
            with Interrupts() as interrupts:
                if not folder.checkpoint.is_file():
                    self.save(folder.checkpoint)  # from now on the run can be resumed
                try:
                    self._advance(folder, console, recorder, interrupts)
                except ConnectionError:  # of the workers: nothing that was learned is lost with them
                    self.save(folder.checkpoint)
                    raise
                self.save(folder.checkpoint)
                self._save_policy(folder)
            begin = time.perf_counter()
            evaluation = None if interrupts.requested else self._evaluate(folder)
            evaluated = time.perf_counter() - begin
            self._draw_curve(folder, recorder, evaluation)
            if evaluation is not None and self.settings.randomize and has("onnx") and has("matplotlib"):
                self._draw_randomization(folder)
            return Outcome(
                solved=self.metrics.solved,
                env_steps=self.metrics.env_steps,
                training_seconds=recorder.seconds,
                evaluation_seconds=evaluated,
                waited_seconds=0.0 if self._workers is None else self._workers.waited_seconds,
                evaluation=evaluation,
            )

    def _advance(self, folder: RunFolder, console: Console, recorder: Recorder, interrupts: Interrupts) -> None:
        piece = 1
        last_checkpoint = time.monotonic()
        settings = self.settings
        known = expected(settings)
        steps = None if known is None else known.env_steps
        with TrainingProgress(console, settings.env_id, settings.max_env_steps, steps, settings.workers) as progress:
            advance = self._advancer(progress, interrupts)
            while (left := self.iterations_left) > 0 and not interrupts.requested:
                begin = time.perf_counter()
                metrics = advance(min(piece, left))
                elapsed = time.perf_counter() - begin
                progress.update(recorder.add(metrics, elapsed))
                folder.evaluation.unlink(missing_ok=True)  # it was of the policy before
                shortest, longest = _SECONDS_PER_PIECE
                wanted = min(max(shortest, _SHARE_PER_PIECE * recorder.seconds), longest)
                piece = max(1, round(piece * min(wanted / max(elapsed, 1e-6), 2.0)))
                first, later = _SECONDS_PER_CHECKPOINT
                if time.monotonic() - last_checkpoint > min(max(first, recorder.seconds / 3), later):
                    self.save(folder.checkpoint)
                    last_checkpoint = time.monotonic()
            if interrupts.requested:
                progress.say("Stopping: what was learned is being saved ...")

    def _advancer(self, progress: TrainingProgress, interrupts: Interrupts) -> Callable[[int], TrainMetrics]:
        """What runs iterations: the trainer, or the workers of a cluster and the trainer."""
        if self.settings.workers is None:
            return self._trainer.advance
        from manyhands.training.cluster import Workers
        from manyhands.training.spread import Spread

        self._workers = Workers(self.settings, progress.say)
        spread = Spread(self._trainer, self._workers, self.settings.trainer_config().round_steps)
        return lambda iterations: spread.advance(iterations, lambda: interrupts.requested)

    def _save_policy(self, folder: RunFolder) -> None:
        if not has("onnx"):
            return
        with held():
            from manyhands.training.policy_file import save_policy

        save_policy(self._trainer.policy(), self.settings.env_id, folder.policy, self.settings.cameras)

    def _draw_curve(self, folder: RunFolder, recorder: Recorder, last: Evaluation | None) -> None:
        if not recorder.rows or not has("matplotlib"):
            return
        with held():
            from manyhands.training.curve import draw_curve

        draw_curve(folder, recorder.rows, f"{self.settings.env_id}, seed {self.settings.seed}", last)

    def _draw_randomization(self, folder: RunFolder) -> None:
        """Success over each range, as a picture."""
        with held():
            from manyhands.training.randomization_picture import draw_randomization

        settings = self.settings
        policy = Policy(folder.policy)
        episodes = run_randomized(policy, settings.env_id, settings.randomize, num_threads=settings.num_threads)
        draw_randomization(folder.randomization, episodes, f"{settings.env_id}, seed {settings.seed}")

    def _evaluate(self, folder: RunFolder) -> Evaluation:
        episodes = self.settings.evaluation_episodes
        result = self._trainer.evaluate(self._evaluation, episodes, FIRST_EVALUATION_SEED)
        evaluation = Evaluation(
            env_id=self.settings.env_id,
            episodes=episodes,
            first_seed=FIRST_EVALUATION_SEED,
            success_rate=result.success_rate,
            mean_return=result.mean_return,
            mean_length=result.mean_length,
        )
        write_text(folder.evaluation, json.dumps(asdict(evaluation), indent=2) + "\n")
        return evaluation
