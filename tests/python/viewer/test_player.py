"""The clock of the page: playing, pausing, rewinding; no browser is needed."""

import threading
import time
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from viewed import falling_ball, until

from manyhands.viewer import controls
from manyhands.viewer.history import History
from manyhands.viewer.player import Frame, Player
from manyhands.viewer.sources import WorldSource


class Handle:
    """A slider of the page: what its user enters is there before anybody is told."""

    value = 0.0

    def on_update(self, tell: Any) -> None:
        self.tell = tell


def test_what_is_entered_is_not_overwritten(monkeypatch: pytest.MonkeyPatch) -> None:
    handle, entered = Handle(), []
    slider = controls.SharedSlider(handle, entered.append)
    slider.show(0.3)
    assert handle.value == 0.3
    handle.value = 0.8
    slider.show(0.3)
    assert handle.value == 0.8
    handle.tell(SimpleNamespace(client_id=1))
    assert entered == [0.8]
    slider.show(0.3)  # nor shortly after
    assert handle.value == 0.8
    monkeypatch.setattr(controls, "_TOUCHED_FOR", 0.0)
    slider.show(0.3)
    assert handle.value == 0.3
    handle.tell(SimpleNamespace(client_id=None))  # what the simulation shows is not entered
    assert entered == [0.8]


def test_history_goes_back_to_the_last_state_before() -> None:
    history = History(5)
    for k in range(10):
        history.add(k * 0.1, k)
    assert history.span == pytest.approx((0.5, 0.9))
    assert [entry[1] for moment in (0.0, 0.5, 0.64, 0.9, 7.0) if (entry := history.at(moment))] == [5, 5, 6, 9, 9]
    history.add(0.62, "again")
    assert history.span[1] == 0.62


@pytest.fixture
def frames() -> list[Frame]:
    return []


@pytest.fixture
def player(frames: list[Frame]) -> Iterator[Player]:
    player = Player(WorldSource(falling_ball()), frames.append, fps=60)
    player.start()
    yield player
    player.close()


def test_time_passes_only_when_it_is_played(player: Player) -> None:
    time.sleep(0.1)
    assert player.source.time == 0
    player.step(3)
    until(lambda: player.source.time > 0)
    time.sleep(0.1)
    assert player.source.time == pytest.approx(3 * player.source.dt)
    player.playing = True
    start, simulated = time.perf_counter(), player.source.time
    time.sleep(0.5)
    player.playing = False
    time.sleep(0.05)
    assert player.source.time - simulated == pytest.approx(time.perf_counter() - start, abs=0.25)
    stopped = player.source.time
    time.sleep(0.1)
    assert player.source.time == stopped


def test_rewinding_and_playing_on_gives_the_same_bits(player: Player) -> None:
    world = player.source.world
    assert world is not None
    player.speed, player.playing = 5.0, True
    until(lambda: player.source.time > 0.8)
    player.playing = False
    player.do(lambda: None, wait=2.0)
    end, hash_there = world.time, world.state_hash()
    player.rewind(0.3)
    player.do(lambda: None, wait=2.0)
    assert 0.3 - 0.1 < world.time <= 0.3
    steps = round((end - world.time) / world.time_step)
    player.step(steps)
    until(lambda: world.time >= end - 1e-9)
    time.sleep(0.05)
    assert world.state_hash() == hash_there


def test_a_reset_can_be_rewound(player: Player) -> None:
    player.speed, player.playing = 5.0, True
    until(lambda: player.source.time > 0.5)
    player.restart()
    until(lambda: player.source.time < 0.2)
    assert player.moment > 0.5
    player.rewind(0.4)
    player.do(lambda: None, wait=2.0)
    assert 0.3 < player.source.time <= 0.4


def test_a_loop_that_syncs_keeps_real_time_and_waits_while_paused(player: Player, frames: list[Frame]) -> None:
    world = player.source.world
    assert world is not None
    start = time.perf_counter()
    for _ in range(100):
        world.step()
        player.sync()
    assert time.perf_counter() - start > 0.18
    assert len(frames) < 30
    player.playing = False
    went_on = threading.Event()
    loop = threading.Thread(target=lambda: (world.step(), player.sync(), went_on.set()), daemon=True)
    loop.start()
    assert not went_on.wait(0.3)
    player.step()
    assert went_on.wait(2.0)


def test_a_page_that_hangs_does_not_hold_up_a_loop() -> None:
    release = threading.Event()
    player = Player(WorldSource(falling_ball()), lambda _: release.wait(20.0) and None, fps=60)
    player.speed = float("inf")
    player.start()
    start = time.perf_counter()
    world = player.source.world
    assert world is not None
    for _ in range(2000):
        world.step()
        player.sync()
    taken = time.perf_counter() - start
    release.set()
    player.close()
    assert taken < 2.0


def test_a_world_that_explodes_stops_and_says_why(player: Player) -> None:
    world = player.source.world
    assert world is not None

    def throw() -> None:
        world.set_body_velocity("ball", velocity=[1e200, 0, 0])

    player.do(throw, wait=2.0)
    player.playing = True
    until(lambda: player.problem != "")
    assert not player.playing
    player.restart()
    until(lambda: player.problem == "")
    assert world.time == 0


@pytest.mark.parametrize("problem", [TypeError("of a policy"), PermissionError("no room for a file"), IndexError()])
def test_whatever_is_raised_stops_and_the_page_stays_alive(player: Player, problem: Exception) -> None:
    def fail() -> None:
        raise problem

    player.do(fail, wait=2.0)
    until(lambda: player.problem == (str(problem) or "IndexError()"))
    player.problem, player.playing = "", True
    player.source.step = fail
    until(lambda: player.problem != "")
    assert not player.playing
    del player.source.step
    player.restart()
    player.playing = True
    until(lambda: player.source.time > 0)


def test_a_frame_that_cannot_be_drawn_stops_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    drawn: list[Frame] = []

    def draw(frame: Frame) -> None:
        drawn.append(frame)
        if len(drawn) < 3:
            raise KeyError("a body that is gone")

    player = Player(WorldSource(falling_ball()), draw)
    player.start()
    try:
        player.playing = True
        until(lambda: len(drawn) > 5)
        assert player.source.time > 0
    finally:
        player.close()
    assert capsys.readouterr().err.count("KeyError: 'a body that is gone'") == 1  # said, but not thirty times a second
