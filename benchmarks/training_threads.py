"""Training on one and on two threads in turns, alone and beside a program that keeps one core busy.

    python -m benchmarks.training_threads          # two minutes

Two threads give the bits of one; they should never be slower. A ratio is that of the medians.
"""

import argparse
import contextlib
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from manyhands._core.envs import make_adviser, make_env_batch
from manyhands._core.learn import Trainer
from manyhands.training.recipe import find_recipe

ITERATIONS = {"PandaReach-v3": 60, "PandaPush-v3": 60, "PandaFlip-v3": 128}


def steps_per_second(env_id: str, num_threads: int) -> float:
    """Of all worlds, learning included, over the first iterations of the shipped recipe."""
    recipe = find_recipe(env_id)
    assert recipe is not None
    settings = recipe.settings(num_threads=num_threads)
    config = settings.trainer_config()
    envs = make_env_batch(env_id, settings.num_envs, num_threads=num_threads)
    trainer = Trainer(envs, None, config, make_adviser(env_id) if config.wants_expert else None)
    trainer.advance(ITERATIONS[env_id] // 2)  # fills the replay
    begin = time.perf_counter()
    trainer.advance(ITERATIONS[env_id])
    return ITERATIONS[env_id] * settings.num_envs / (time.perf_counter() - begin)


@contextlib.contextmanager
def busy_loops(count: int) -> Iterator[None]:
    """So many other programs that never rest."""
    programs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for program in programs:
            program.kill()
            program.wait()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=9, help="measurements of each kind (default 9)")
    given = parser.parse_args()
    print("| environment | busy loops | one thread, steps/s | two threads | ratio |\n| --- | --- | --- | --- | --- |")
    for env_id in ITERATIONS:
        for loops in (0, 1, 2):
            with busy_loops(loops):
                pairs = [[steps_per_second(env_id, threads) for threads in (1, 2)] for _ in range(given.pairs)]
            one, two = (statistics.median(pair[i] for pair in pairs) for i in (0, 1))
            print(f"| {env_id} | {loops} | {one:,.0f} | {two:,.0f} | {two / one:.2f} |", flush=True)


if __name__ == "__main__":
    main()
