"""Random things on a floor, put into a bin by examples/pick_and_place.py: `python -m benchmarks.pick_and_place`.

Processor time is that of seeing, of grasps and of all plans; the physics is not counted.
"""

import argparse
import time

import numpy as np

from benchmarks.pick_and_place.scenes import in_bin, scene
from examples.pick_and_place import follow, plan_pick, see

_JAWS = (0.0, 0.04, 0.0)  # open, closed, open [m]


def clear(seed: int, count: int) -> tuple[int, int, list[float]]:
    """How many things end in the bin, how often the arm went, and the processor time of each decision [s]."""
    world, names = scene(seed, count)
    seconds: list[float] = []
    for _ in range(2 * count):
        start = time.process_time()
        plans = plan_pick(see(world))
        seconds.append(time.process_time() - start)
        if not plans:
            break
        for plan, jaw in zip(plans, _JAWS, strict=True):
            follow(world, plan, jaw)
    world.step(250)
    return len(in_bin(world, names)), len(seconds) - 1, seconds


def main() -> None:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.pick_and_place",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--scenes", type=int, default=20)
    parser.add_argument("--things", type=int, default=5, help="in each scene")
    options = parser.parse_args()
    print("| scene | in the bin | goes | median s of a decision | longest |\n| --- | --- | --- | --- | --- |")
    moved, all_seconds = 0, []
    for seed in range(options.scenes):
        done, goes, seconds = clear(seed, options.things)
        moved += done
        all_seconds += seconds
        print(
            f"| {seed} | {done} of {options.things} | {goes} | {np.median(seconds):.2f} | {max(seconds):.2f} |",
            flush=True,
        )
    total = options.scenes * options.things
    print(
        f"| all | {moved} of {total}, {moved / total:.0%} | | {np.median(all_seconds):.2f} | {max(all_seconds):.2f} |"
    )


if __name__ == "__main__":
    main()
