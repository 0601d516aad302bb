"""Plans under a constraint and plans on the way, of the examples: `python -m benchmarks.planning.constrained`.

Milliseconds of the least of three runs of each seed; tilts by forward kinematics at every millimetre of the curves.
"""

import argparse
import os
import runpy
import time
from pathlib import Path
from typing import Any

import numpy as np

import manyhands as mh
from manyhands import planning

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
TOLERANCES = (0.5, 0.15, 0.05, 0.02)  # [rad]
RUNS = 3
MILLIMETRE = 1e-3


def tilt(example: dict[str, Any], planner: planning.Planner, curve: planning.Trajectory) -> float:
    """The most along the curve, looked at so often that the hand moves by a millimetre at most [rad]."""
    q = curve.sample(np.linspace(0, curve.duration, 1000)).q
    p, _ = mh.kinematics.forward(planner.model, planner.configuration(q), example["HAND"])
    longest = float(np.linalg.norm(np.diff(p, axis=0), axis=1).max())
    return example["most_tilt"](planner, curve, 1000 * int(np.ceil(1.1 * longest / MILLIMETRE)))


def upright(seeds: int) -> None:
    example = runpy.run_path(str(EXAMPLES / "upright_cup.py"))
    planner = planning.Planner(example["scene"](), example["HAND"], attached={"cup": "panda_hand"})
    for within in (*TOLERANCES, None):
        keep = () if within is None else planning.upright("cup", within=within)
        rows, tilts = [], []
        for seed in range(seeds):
            runs = [planner.plan(example["RIGHT"], keep=keep, seed=seed, time_limit=5.0) for _ in range(RUNS)]
            best = min(runs, key=lambda plan: plan.search_time + plan.shorten_time)
            if best.curve is None:
                continue
            rows.append((best.search_time, best.search_time + best.shorten_time, best.length))
            tilts.append(tilt(example, planner, best.curve))
        search, whole, length = np.median(rows, axis=0)
        print(
            f"within {within}: {len(rows)} of {seeds} solved; search {1e3 * search:.2f}, all {1e3 * whole:.1f} ms; "
            f"length {length:.2f} rad; tilted by {max(tilts):.4f} rad at most"
        )


def replanned(seeds: int) -> None:
    example = runpy.run_path(str(EXAMPLES / "replanning.py"))
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.add_plane("floor")
    planner = planning.Planner(world, example["HAND"])
    motion, points = example["on_the_way"](planner), example["points_of_ball"]()
    began = time.perf_counter()
    changed = planner.with_cloud(points)
    print(f"with_cloud of {len(points)} points: {1e3 * (time.perf_counter() - began):.2f} ms")
    for limit in (0.05, 0.15):
        given = (changed, motion, example["SEEN"], example["GOAL"])
        found = [example["replan"](*given, **example["LIMITS"], time_limit=limit, seed=seed) for seed in range(seeds)]
        took = [1e3 * one.took for one in found]
        solved = [one.motion.duration for one in found if one.success]
        print(
            f"replan within {1e3 * limit:.0f} ms: {len(solved)} of {seeds} solved, took {np.median(took):.0f} ms, "
            f"95 % {np.percentile(took, 95):.0f}, most {max(took):.0f}; the motions last {np.median(solved):.2f} s"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    seeds = parser.parse_args().seeds
    print(f"load {os.getloadavg()[0]:.0f} on {os.cpu_count()} cores")
    upright(seeds)
    replanned(seeds)


if __name__ == "__main__":
    main()
