"""The clock of a page: plays, pauses and steps, in a thread of its own or in step with somebody else's loop."""

import math
import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from manyhands._core import Contact
from manyhands.viewer.history import History
from manyhands.viewer.sources import Marker, Neighbours, Source

_DRIVEN_FOR = 1.0  # a loop that called `sync` this recently [s] moves the simulation itself
_MINUTES = 3.0
_SHARE = 0.15  # of the interpreter's time, at most, for a page whose program does not wait for it
_IDLE = 0.25  # [s] between frames of such a page while nobody has it open


class Frame(NamedTuple):
    """What is drawn, copied from the simulation."""

    time: float
    """[s]"""
    moment: float
    """The same on a clock that resets do not turn back [s]."""
    parts: tuple[Any, ...]
    positions: NDArray[np.float64]
    quaternions: NDArray[np.float64]
    markers: list[Marker]
    contacts: list[Contact]
    values: dict[str, NDArray[np.float64]]
    neighbours: Neighbours | None


class Player:
    """Moves a source at a chosen speed, and hands out frames at no more than `fps` a second.

    Everything that touches the source happens in one thread at a time: the player's own, or, while somebody else's
    loop calls `sync`, in that one. `do` is how others ask for something. Who draws the frames does not hold up who
    simulates.
    """

    def __init__(
        self,
        source: Source,
        draw: Callable[[Frame], None],
        fps: float = 30.0,
        is_seen: Callable[[], bool] = lambda: True,
    ) -> None:
        """is_seen: whether anybody has the page open."""
        self.source, self.fps = source, fps
        self.speed = 1.0
        """Simulated seconds in a second; infinite: as fast as it goes."""
        self.playing = False
        self.problem = ""
        """Why the last step failed; empty if it did not."""
        self.before_step: Callable[[], None] = lambda: None
        """What drives the source, before each step."""
        self.watched: dict[str, Callable[[], Any]] = {}
        """What frames are to measure besides: names, and what gives a number or an array (k)."""
        self.wants_contacts = False
        self.history = History(int(_MINUTES * 60 * fps))
        self.rate = 0.0
        """Simulated seconds in the last second."""
        self._draw, self._is_seen = draw, is_seen
        self._jobs: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._source_turn = threading.RLock()
        self._frame: Frame | None = None
        self._closed = threading.Event()
        self._woken = threading.Event()
        self._last_sync = -math.inf
        self._is_syncing = False
        self._anchor: tuple[float, float] | None = None  # of the pace: on the wall's clock, in simulated time
        self._last_capture = -math.inf
        self._owed = 0.0
        self._steps_wanted = 0
        self._said: set[str] = set()  # of frames that could not be drawn
        self._offset, self._moment = 0.0, source.time  # of the clock that resets do not turn back
        self._rate_from = (time.perf_counter(), source.time)
        self._thread = threading.Thread(target=self._run, name="manyhands viewer", daemon=True)

    def start(self) -> None:
        self._remember()
        self._thread.start()

    def close(self) -> None:
        """Ends the thread; lets a loop go that waits in `sync`."""
        self._closed.set()
        self._woken.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=2.0)

    @property
    def is_closed(self) -> bool:
        return self._closed.is_set()

    @property
    def is_driven(self) -> bool:
        """Whether somebody else's loop moves the simulation."""
        return self._is_syncing or time.perf_counter() - self._last_sync < _DRIVEN_FOR

    def do(self, job: Callable[[], None], wait: float = 0.0) -> bool:
        """Has something done between two steps; waits so many seconds until it is. Gives whether it is."""
        if wait <= 0:
            self._jobs.put(job)
            self._woken.set()
            return False
        done = threading.Event()

        def signal() -> None:
            try:
                job()
            finally:
                done.set()

        self._jobs.put(signal)
        self._woken.set()
        return done.wait(wait)

    def step(self, n: int = 1) -> None:
        """Pauses, and asks for n steps."""
        self.playing = False
        self._steps_wanted += n
        self._woken.set()

    @property
    def moment(self) -> float:
        """Simulated time [s] on a clock that goes on through resets; `rewind` alone turns it back."""
        now = self.source.time + self._offset
        if now < self._moment:
            self._offset += self._moment - now
            now = self._moment
        self._moment = now
        return now

    def rewind(self, moment: float) -> None:
        """Pauses at a moment [s] of the last minutes, the nearest before it that is remembered."""

        def go() -> None:
            entry = self.history.at(moment)
            if entry is not None:
                self.playing = False
                self.source.restore(entry[1])
                self._moment = entry[0]
                self._offset = entry[0] - self.source.time

        self.do(go)

    def restart(self, reset: Callable[[], None] | None = None) -> None:
        """Resets the source; what was before can be gone back to."""

        def go() -> None:
            (reset or self.source.reset)()
            self.problem = ""
            self._remember()

        self.do(go)

    # ---- in somebody else's loop ---------------------------------------------------------------------------------

    def sync(self) -> None:
        """To be called after each step of a loop that moves the source itself: keeps the pace, and waits while paused.
        Never waits for a browser. The first call starts to play."""
        if self._is_syncing or threading.current_thread() is self._thread:
            return  # what the page itself asked for has made a step
        with self._source_turn:
            self._is_syncing = True
            try:
                self.source.tick()
                self.before_step()
                if self._last_sync == -math.inf:
                    self.playing = True
                self._work()
                self._remember_sometimes()
                self._capture()
                self._keep_pace()
                while not (self.playing or self._closed.is_set()):
                    if self._steps_wanted > 0:
                        self._steps_wanted -= 1
                        break
                    self._capture()
                    self._woken.wait(1 / self.fps)
                    self._woken.clear()
                    self._work()
                    self._anchor = None
            finally:
                self._last_sync = time.perf_counter()
                self._is_syncing = False

    def _keep_pace(self) -> None:
        now, simulated = time.perf_counter(), self.source.time
        if self._anchor is None or simulated < self._anchor[1] or not math.isfinite(self.speed):
            self._anchor = now, simulated
            return
        due = self._anchor[0] + (simulated - self._anchor[1]) / self.speed
        if due > now:
            self._closed.wait(due - now)
        elif now - due > 0.1:  # who comes late is not hurried afterwards
            self._anchor = now, simulated

    # ---- in a thread of its own ----------------------------------------------------------------------------------

    def _run(self) -> None:
        while not self._closed.is_set():
            begin, worked = time.perf_counter(), time.thread_time()
            if not self.is_driven and self._source_turn.acquire(blocking=False):
                try:
                    self._work()
                    self._advance()
                    self._capture()
                finally:
                    self._source_turn.release()
            frame, self._frame = self._frame, None
            if frame is not None:
                self._show(frame)
            self._measure_rate()
            left = 1 / self.fps - (time.perf_counter() - begin)
            if self.source.only_watched:
                left = max(left, (time.thread_time() - worked) / _SHARE, 0.0 if self._is_seen() else _IDLE)
            if left > 0:
                self._closed.wait(left)

    def _show(self, frame: Frame) -> None:
        """Draws a frame; what cannot be drawn is said once on the terminal, and does not stop who simulates."""
        try:
            self._draw(frame)
        except Exception as reason:
            if repr(reason) not in self._said:
                self._said.add(repr(reason))
                traceback.print_exc()

    def _work(self) -> None:
        """Does what was asked for."""
        while True:
            try:
                job = self._jobs.get_nowait()
            except queue.Empty:
                return
            try:
                job()
            except Exception as reason:
                self._fail(reason)

    def _advance(self) -> None:
        """What a frame's time brings, or as much of it as there is time for: then it is slow motion."""
        if not self.source.moves:
            return
        begin, budget = time.perf_counter(), 0.8 / self.fps
        self._owed = self._owed + self.speed / self.fps if self.playing else 0.0
        while (self._steps_wanted > 0 or self._owed >= self.source.dt) and not self.problem:
            try:
                self.before_step()
                self.source.step()
            except Exception as reason:  # policies and tasks are other people's
                self._fail(reason)
                return
            if self._steps_wanted > 0:
                self._steps_wanted -= 1
            else:
                self._owed -= self.source.dt + self.source.rest * min(1.0, self.speed)
            if time.perf_counter() - begin > budget:
                self._owed = min(self._owed, self.source.dt)
                break
        self._remember_sometimes()

    def _fail(self, reason: Exception) -> None:
        self.playing, self.problem, self._steps_wanted = False, str(reason) or repr(reason), 0

    def _remember_sometimes(self) -> None:
        if not len(self.history) or self.moment >= self.history.span[1] + 1 / self.fps:
            self._remember()

    def _remember(self) -> None:
        self.history.add(self.moment, self.source.save())

    def _capture(self) -> None:
        """Copies a frame for the page, if it is time for one."""
        now = time.perf_counter()
        if now - self._last_capture < 0.7 / self.fps:
            return
        self._last_capture, source = now, self.source
        source.refresh()
        contacts = source.world.contacts() if self.wants_contacts and source.world is not None else []
        values = {
            name: np.atleast_1d(np.asarray(measure(), np.float64)) for name, measure in list(self.watched.items())
        }
        self._frame = Frame(
            source.time, self.moment, source.parts(), *source.poses(), source.markers(), contacts, values,
            source.neighbours(),
        )  # fmt: skip

    def _measure_rate(self) -> None:
        now, (since, simulated) = time.perf_counter(), self._rate_from
        if now - since > 0.5:
            self.rate = max(0.0, (self._moment - simulated) / (now - since))
            self._rate_from = now, self._moment
