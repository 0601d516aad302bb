"""Plans among obstacles on one core: `python -m benchmarks.planning`.

Each problem is planned several times with the same seed, and the least time counts: plans are the same, and what else
the machine does is not. Beside a search with shortcuts, its path is smoothed by optimisation, or paths are optimised
without a search. Every plan is judged by exact distances, looked at on every millimetre of its way. "duration" is that
of the fastest motion along its curve; "jerk" the most, from one millisecond to the next, of a motion whose length
follows a quintic as fast as limits let. Where OMPL is installed, `pip install manyhands[peers]`, its RRT-Connect and
shortcuts do the same, once each.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.planning import ompl_peer
from benchmarks.planning.scenes import ROBOTS, SCENES, Problem, problems
from manyhands import planning

Array = NDArray[np.float64]
_OUT = Path("build/planning.json")
_OURS = "manyhands"
_ACCELERATION = 5.0  # limit of each joint [rad/s^2]


def measure(problem: Problem, repeats: int, time_limit: float, others: bool) -> list[dict[str, Any]]:
    """Times [s], length and least distance [m] of one problem's plans, by planner."""
    about = {"robot": problem.robot.name, "scene": problem.scene, "number": problem.number}
    rows = [about | {"planner": name} | _own(problem, find, repeats, time_limit) for name, find in _WAYS.items()]
    for name, whole_ways in ompl_peer.VARIANTS.items() if others else ():
        rows.append(about | {"planner": name} | ompl_peer.plan(problem, time_limit, whole_ways))
    return rows


def _search(problem: Problem, time_limit: float, smooth: bool = False) -> planning.Plan:
    return problem.planner.plan(
        problem.goal, start=problem.start, time_limit=time_limit, seed=problem.number, smooth=smooth
    )


def _smooth(problem: Problem, time_limit: float) -> planning.Plan:
    return _search(problem, time_limit, smooth=True)


def _optimize(problem: Problem, time_limit: float) -> planning.Plan:
    return problem.planner.optimize(problem.goal, start=problem.start, time_limit=time_limit, seed=problem.number)


_WAYS: dict[str, Callable[[Problem, float], planning.Plan]] = {
    _OURS: _search,
    "smooth": _smooth,
    "optimised": _optimize,
}


def _own(
    problem: Problem, find: Callable[[Problem, float], planning.Plan], repeats: int, time_limit: float
) -> dict[str, Any]:
    plan = find(problem, time_limit)
    plans = [plan, *(find(problem, time_limit) for _ in range(repeats - 1 if plan.success else 0))]
    judged = problem.planner.least_distance(plan.waypoints) if plan.success else None
    return {
        "solved": plan.success,
        "search": min(plan.search_time for plan in plans),
        "shorten": min(plan.shorten_time for plan in plans),
        "nodes": plan.nodes,
        "length": plan.length if plan.success else None,
        "distance": None if judged is None else judged.distance,
        "duration": plan.trajectory(acceleration=_ACCELERATION).duration if plan.curve else None,
        "jerk": _jerk(plan.curve, problem.planner.velocity) if plan.curve else None,
    }


def _jerk(curve: planning.Trajectory, velocity: Array) -> float:
    """The most, of any joint [rad/s^3], where the curve's length follows a quintic from rest to rest."""
    slowest = 100.0  # [s], from which the limits tell how fast it can be
    law = planning.quintic([0, slowest], [[0.0], [curve.duration]])

    def followed(times: Array) -> tuple[Array, Array]:
        s, ds, dds = law.sample(times)
        _, slope, bend = curve.sample(s[:, 0])
        return slope * ds, slope * dds + bend * ds**2

    v, a = followed(np.linspace(0, slowest, 10_000))
    faster = min((velocity / np.abs(v).max(axis=0)).min(), np.sqrt(_ACCELERATION / np.abs(a).max()))
    _, a = followed(np.arange(0, slowest, faster * 1e-3))
    return float(np.abs(np.diff(a * faster**2, axis=0)).max() / 1e-3)


def print_lines(name: str, rows: list[dict[str, Any]]) -> None:
    """One for each planner."""
    for planner in dict.fromkeys(row["planner"] for row in rows):
        print("\r" + line(name if planner == _OURS else f"  {planner}", [r for r in rows if r["planner"] == planner]))


def line(name: str, rows: list[dict[str, Any]]) -> str:
    solved = [row for row in rows if row["solved"]]
    search = np.array([row["search"] for row in rows]) * 1e6
    whole = search + np.array([row["shorten"] for row in rows]) * 1e6
    length = np.mean([row["length"] for row in solved]) if solved else np.nan
    least = min((row["distance"] for row in solved), default=float("nan"))
    duration, jerk = (
        np.mean([row[key] for row in solved if row.get(key)]) if any(row.get(key) for row in solved) else np.nan
        for key in ("duration", "jerk")
    )
    return (
        f"{name:<20}{len(solved):>4}/{len(rows):<4}{np.median(search):>9.0f}{np.percentile(search, 95):>9.0f}"
        f"{np.median(whole):>9.0f}{np.percentile(whole, 95):>9.0f}{length:>8.2f}{least * 1e3:>9.2f}"
        f"{duration:>9.2f}{jerk:>9.0f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="problems of each scene and robot")
    parser.add_argument("--scenes", nargs="*", default=list(SCENES), choices=list(SCENES))
    robots = [robot.name for robot in ROBOTS]
    parser.add_argument("--robots", nargs="*", default=robots, choices=robots)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--time-limit", type=float, default=5.0, help="[s]")
    arguments = parser.parse_args()
    rows: list[dict[str, Any]] = []
    others = ompl_peer.is_installed()
    if not others:
        print("OMPL: not installed")
    print(
        f"{'':<20}{'solved':>9}{'search us':>9}{'95 %':>9}{'+ short':>9}{'95 %':>9}{'length':>8}{'least mm':>9}"
        f"{'duration':>9}{'jerk':>9}"
    )
    begin = time.perf_counter()
    for robot in (robot for robot in ROBOTS if robot.name in arguments.robots):
        of_robot: list[dict[str, Any]] = []
        for scene in arguments.scenes:
            found: list[dict[str, Any]] = []
            for problem in problems(robot, scene, arguments.count):
                found += measure(problem, arguments.repeats, arguments.time_limit, others)
                print(f"\r{robot.name} {scene} {problem.number + 1}", end="", flush=True)
            print_lines(f"{robot.name} {scene}", found)
            of_robot += found
        print_lines(f"{robot.name} all", of_robot)
        rows += of_robot
    _OUT.parent.mkdir(exist_ok=True)
    _OUT.write_text(json.dumps({"rows": rows, "seconds": time.perf_counter() - begin}, indent=1))


if __name__ == "__main__":
    main()
