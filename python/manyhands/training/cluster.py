"""Worlds of a training on the machines of a Ray cluster."""

import socket
import time
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any

from manyhands._core.envs import make_adviser, make_env_batch
from manyhands._core.learn import Share
from manyhands.extras import needs
from manyhands.training.settings import TrainSettings, shares_of

with needs("ray", "--ray"):
    import ray  # pyright: ignore[reportMissingImports]
    from ray.exceptions import RayError, RayTaskError  # pyright: ignore[reportMissingImports]

_SECONDS_PER_LOOK = 0.5  # at what else there is to do while workers work
_PATIENCE_SECONDS = 20.0  # with workers, before it is told that they are waited for
_MOST_LOSSES = 5  # of a worker in one round: then something is wrong with more than a machine


class Cluster:
    """A connection to a Ray cluster, until the end of the block."""

    def __init__(self, address: str) -> None:
        """address: host:port, "auto" for the cluster of this machine, "local" for a new one here.

        Raises ConnectionError if there is none.
        """
        _knock(address)
        try:
            ray.init(address=address, log_to_driver=False, logging_level="error", ignore_reinit_error=True)
        except (ConnectionError, RuntimeError, ValueError, OSError) as reason:
            said = " ".join(f"{reason}".split())
            raise ConnectionError(f"no Ray cluster can be used at {address!r}: {said}") from reason

    def default_workers(self) -> int:
        """One for each processor of the cluster but one, on which the trainer learns."""
        return max(1, int(ray.cluster_resources().get("CPU", 1)) - 1)

    def __enter__(self) -> "Cluster":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        ray.shutdown()


class _Worker:
    """Runs its share of the worlds, in a process somewhere."""

    def __init__(self, settings: TrainSettings, first: int, count: int) -> None:
        config = settings.trainer_config()
        self._envs = make_env_batch(settings.env_id, count, num_threads=1, randomize=settings.ranges)
        self._expert = make_adviser(settings.env_id) if config.wants_expert else None
        self._share = Share(self._envs, self._expert, config, first)

    def run(self, order: bytes, place: bytes) -> bytes:
        return self._share.run(order, place)


class Workers:
    """Runs orders of a trainer. A worker that is lost is replaced by a new one, which does the same again."""

    def __init__(self, settings: TrainSettings, tell: Callable[[str], None]) -> None:
        """`tell` hears of losses. The cluster starts the workers when it can."""
        self._settings = settings
        self._tell = tell
        self.shares = shares_of(settings.num_envs, settings.workers or 1)
        self.waited_seconds = 0.0
        self._places: Sequence[bytes] = []
        self._order: Any = None
        # The processors are reserved in the beginning, so that workers spread over them.
        self._workers = [self._start(share, cpus=1) for share in range(len(self.shares))]
        self._running: list[Any] = []

    def send(self, order: bytes, places: Sequence[bytes]) -> None:
        """Begins a round."""
        self._order, self._places = ray.put(order), places
        self._running = [self._run(share) for share in range(len(self._workers))]

    def gather(self, stopped: Callable[[], bool]) -> list[bytes] | None:
        """What all have brought; None if stopped before. Raises ConnectionError if a worker fails whatever is tried."""
        begin = time.perf_counter()
        results: dict[int, bytes] = {}
        losses = [0] * len(self._workers)  # in this round
        told = False
        while left := [share for share in range(len(self._workers)) if share not in results]:
            if stopped():
                return None
            if not told and time.perf_counter() - begin > _PATIENCE_SECONDS:
                told = True
                free, cpus = ray.available_resources().get("CPU", 0), ray.cluster_resources().get("CPU", 0)
                text = (
                    f"Waiting for {len(left)} of {len(self._workers)} workers. Of the cluster's {cpus:.0f} processors"
                )
                self._tell(f"{text} {free:.0f} are free.")
            running = [self._running[share] for share in left]
            ready, _ = ray.wait(running, num_returns=len(running), timeout=_SECONDS_PER_LOOK)
            for share in (share for share in left if self._running[share] in ready):
                result = self._result(share)
                if isinstance(result, bytes):
                    results[share] = result
                    continue
                losses[share] += 1
                if losses[share] >= _MOST_LOSSES:
                    text = f"worker {share} was lost {_MOST_LOSSES} times in a row: {_last_line(result)}"
                    raise ConnectionError(text) from result
                self._tell(f"Worker {share} was lost; what it was doing is done again elsewhere.")
                self._replace(share)
        self.waited_seconds += time.perf_counter() - begin
        return [results[share] for share in range(len(self._workers))]

    def _result(self, share: int) -> bytes | Exception:
        """What a worker brought, or how it was lost."""
        try:
            return ray.get(self._running[share])
        except RayTaskError as error:
            raise ConnectionError(f"worker {share} failed: {_last_line(error)}") from error
        except RayError as error:
            return error

    def _start(self, share: int, cpus: int) -> Any:
        remote = ray.remote(_Worker).options(num_cpus=cpus, scheduling_strategy="SPREAD")
        return remote.remote(self._settings, sum(self.shares[:share]), self.shares[share])

    def _run(self, share: int) -> Any:
        return self._workers[share].run.remote(self._order, self._places[share])

    def _replace(self, share: int) -> None:
        """By one that asks for no processor of its own: with a machine less there may be none."""
        ray.kill(self._workers[share])
        self._workers[share] = self._start(share, cpus=0)
        self._running[share] = self._run(share)


def _knock(address: str) -> None:
    """Raises ConnectionError unless somebody listens at host:port: Ray itself tries for more than a minute."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if not (host and port.isdigit()):
        return
    try:
        socket.create_connection((host, int(port)), timeout=10).close()
    except (OSError, OverflowError) as reason:
        raise ConnectionError(f"no Ray cluster answers at {address!r}: {reason}") from reason


def _last_line(error: Exception) -> str:
    return next((line for line in reversed(f"{error}".splitlines()) if line.strip()), type(error).__name__).strip()
