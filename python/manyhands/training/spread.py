"""A trainer whose worlds run in the workers of a cluster."""

from collections.abc import Callable

from manyhands._core.learn import Trainer, TrainMetrics
from manyhands.training.cluster import Workers


class Spread:
    """Advances a trainer round by round: while it learns from one, the workers run the next."""

    def __init__(self, trainer: Trainer, workers: Workers, round_steps: int) -> None:
        """Begins where the trainer stands."""
        self._trainer = trainer
        self._workers = workers
        self._round_steps = round_steps
        self._send()

    def advance(self, iterations: int, stopped: Callable[[], bool]) -> TrainMetrics:
        """About as many iterations more, in whole rounds; fewer if stopped. Raises ConnectionError as `gather`."""
        for _ in range(max(1, round(iterations / self._round_steps))):
            if self._trainer.metrics().solved:
                break
            results = self._workers.gather(stopped)
            if results is None:
                break
            self._trainer.receive(results)
            self._send()
            self._trainer.learn()
        return self._trainer.metrics()

    def _send(self) -> None:
        places = [self._trainer.place(share) for share in range(len(self._workers.shares))]
        self._workers.send(self._trainer.order, places)
