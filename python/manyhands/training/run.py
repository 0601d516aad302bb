"""A training run from the first step to the files it leaves."""

import json
import math
import time
from dataclasses import asdict, dataclass

from rich.console import Console

from manyhands._core.envs import make_env_batch, make_expert
from manyhands._core.learn import Trainer, TrainMetrics
from manyhands.envs.cameras import eyes
from manyhands.files import write_text
from manyhands.interrupts import Interrupts
from manyhands.training.curve import draw_curve
from manyhands.training.evaluation import Evaluation
from manyhands.training.policy_file import save_policy
from manyhands.training.progress import TrainingProgress
from manyhands.training.recorder import Recorder
from manyhands.training.run_folder import RunFolder
from manyhands.training.settings import FIRST_EVALUATION_SEED, TrainSettings

_SECONDS_PER_PIECE = (0.05, 1.0)  # of training between two looks at it: shortest and longest
_SHARE_PER_PIECE = 0.01  # of the training so far, between these
_SECONDS_PER_CHECKPOINT = 30.0


@dataclass(frozen=True)
class Outcome:
    """What became of a run. `evaluation` is None if it was interrupted."""

    solved: bool
    env_steps: int
    training_seconds: float  # periodic evaluations included, across resumptions
    evaluation_seconds: float
    evaluation: Evaluation | None


class TrainingRun:
    """Trains, and writes into its folder as it goes."""

    def __init__(self, folder: RunFolder, settings: TrainSettings, resume: bool = False) -> None:
        """With `resume`, goes on from the folder's checkpoint: raises ValueError if it has none."""
        self._folder = folder
        self._settings = settings
        config = settings.trainer_config()
        threads = settings.num_threads or 0
        self._envs = make_env_batch(settings.env_id, settings.num_envs, num_threads=threads)
        self._evaluation = make_env_batch(settings.env_id, config.evaluation_episodes, num_threads=threads)
        expert = make_expert(settings.env_id) if config.wants_expert else None
        self._trainer = Trainer(self._envs, self._evaluation, config, expert, eyes(self._envs, settings.cameras))
        if resume:
            if not folder.checkpoint.is_file():
                raise ValueError(f"{folder.path} has no checkpoint to resume from; start again with a new run")
            self._trainer.load(folder.checkpoint)

    @property
    def metrics(self) -> TrainMetrics:
        """Where training stands."""
        return self._trainer.metrics()

    def train(self, console: Console) -> Outcome:
        """Trains until solved, at the step limit, or interrupted; then evaluates, unless interrupted."""
        if self._iterations_left() > 0:
            self._folder.evaluation.unlink(missing_ok=True)  # it was of the policy before
        with Recorder(self._folder, self._settings.num_envs, self.metrics.iterations) as recorder:
            with Interrupts() as interrupts:
                self._advance(console, recorder, interrupts)
                self._trainer.save(self._folder.checkpoint)
                save_policy(self._trainer.policy(), self._settings.env_id, self._folder.policy, self._settings.cameras)
                if recorder.rows:
                    title = f"{self._settings.env_id}, seed {self._settings.seed}"
                    draw_curve(self._folder, recorder.rows, title)
            begin = time.perf_counter()
            evaluation = None if interrupts.requested else self._evaluate()
            return Outcome(
                solved=self.metrics.solved,
                env_steps=self.metrics.env_steps,
                training_seconds=recorder.seconds,
                evaluation_seconds=time.perf_counter() - begin,
                evaluation=evaluation,
            )

    def _advance(self, console: Console, recorder: Recorder, interrupts: Interrupts) -> None:
        piece = 1
        last_checkpoint = time.monotonic()
        with TrainingProgress(console, self._settings.env_id, self._settings.max_env_steps) as progress:
            while (left := self._iterations_left()) > 0 and not interrupts.requested:
                begin = time.perf_counter()
                metrics = self._trainer.advance(min(piece, left))
                elapsed = time.perf_counter() - begin
                progress.update(recorder.add(metrics, elapsed))
                shortest, longest = _SECONDS_PER_PIECE
                wanted = min(max(shortest, _SHARE_PER_PIECE * recorder.seconds), longest)
                piece = max(1, round(piece * min(wanted / max(elapsed, 1e-6), 2.0)))
                if time.monotonic() - last_checkpoint > _SECONDS_PER_CHECKPOINT:
                    self._trainer.save(self._folder.checkpoint)
                    last_checkpoint = time.monotonic()

    def _iterations_left(self) -> int:
        metrics = self.metrics
        if metrics.solved:
            return 0
        return math.ceil((self._settings.max_env_steps - metrics.env_steps) / self._settings.num_envs)

    def _evaluate(self) -> Evaluation:
        episodes = self._settings.evaluation_episodes
        result = self._trainer.evaluate(self._evaluation, episodes, FIRST_EVALUATION_SEED)
        evaluation = Evaluation(
            env_id=self._settings.env_id,
            episodes=episodes,
            first_seed=FIRST_EVALUATION_SEED,
            success_rate=result.success_rate,
            mean_return=result.mean_return,
            mean_length=result.mean_length,
        )
        write_text(self._folder.evaluation, json.dumps(asdict(evaluation), indent=2) + "\n")
        return evaluation
