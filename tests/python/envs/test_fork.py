"""A child of fork() steps and renders, whatever other threads of its parent were doing in the same environment."""

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable

import gymnasium
import pytest

import manyhands as mh

CHILDREN = 10


def ends_well(work: Callable[[], object]) -> bool:
    """Whether a child does it within seconds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of forks beside threads: that is what is tried
        child = os.fork()
    if child == 0:
        signal.alarm(20)
        try:
            work()
        except BaseException:
            os._exit(1)
        os._exit(0)
    return os.waitpid(child, 0)[1] == 0


def while_busy(work: Callable[[], object]) -> list[bool]:
    """What becomes of children that are born while another thread does the work again and again."""
    over = threading.Event()

    def run() -> None:
        while not over.is_set():
            work()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        time.sleep(0.1)
        return [ends_well(work) for _ in range(CHILDREN)]
    finally:
        over.set()
        thread.join()


@pytest.mark.parametrize("threads", [1, 3])
def test_stepping(threads: int) -> None:
    envs = gymnasium.make_vec("PandaPush-v3", num_envs=64, num_threads=threads)
    envs.reset(seed=0)
    actions = envs.action_space.sample()
    assert while_busy(lambda: envs.step(actions)) == [True] * CHILDREN


def test_rendering() -> None:
    env = gymnasium.make("PandaPush-v3", render_mode="rgb_array", render_width=64, render_height=64)
    env.reset(seed=0)
    assert while_busy(env.render) == [True] * CHILDREN


def test_dynamics() -> None:
    model, _ = mh.load_urdf(mh.asset_path("panda/panda.urdf"), load_meshes=False)
    q = model.neutral_configuration()
    assert while_busy(lambda: mh.dynamics.crba(model, q)) == [True] * CHILDREN
