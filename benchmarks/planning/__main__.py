"""Plans among obstacles on one core: `python -m benchmarks.planning`.

Each problem is planned several times with the same seed, and the least time counts: plans are the same, and what else
the machine does is not. Every plan is judged by exact distances, looked at on every millimetre of its way.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.planning.scenes import ROBOTS, SCENES, Problem, problems
from manyhands import planning

_OUT = Path("build/planning.json")


def measure(problem: Problem, repeats: int, time_limit: float) -> dict[str, Any]:
    """Times [s], length and least distance [m] of one problem's plan."""

    def plan_once() -> planning.Plan:
        return problem.planner.plan(problem.goal, start=problem.start, time_limit=time_limit, seed=problem.number)

    plan = plan_once()
    plans = [plan, *(plan_once() for _ in range(repeats - 1 if plan.success else 0))]
    judged = problem.planner.least_distance(plan.waypoints) if plan.success else None
    return {
        "robot": problem.robot.name,
        "scene": problem.scene,
        "number": problem.number,
        "solved": plan.success,
        "search": min(plan.search_time for plan in plans),
        "shorten": min(plan.shorten_time for plan in plans),
        "nodes": plan.nodes,
        "length": plan.length if plan.success else None,
        "distance": None if judged is None else judged.distance,
    }


def line(name: str, rows: list[dict[str, Any]]) -> str:
    solved = [row for row in rows if row["solved"]]
    search = np.array([row["search"] for row in rows]) * 1e6
    whole = search + np.array([row["shorten"] for row in rows]) * 1e6
    lengths = [row["length"] for row in solved]
    least = min((row["distance"] for row in solved), default=float("nan"))
    return (
        f"{name:<16}{len(solved):>4}/{len(rows):<4}{np.median(search):>9.0f}{np.percentile(search, 95):>9.0f}"
        f"{np.median(whole):>9.0f}{np.percentile(whole, 95):>9.0f}{np.mean(lengths):>8.2f}{least * 1e3:>9.2f}"
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
    print(f"{'':<16}{'solved':>9}{'search us':>9}{'95 %':>9}{'+ short':>9}{'95 %':>9}{'length':>8}{'least mm':>9}")
    begin = time.perf_counter()
    for robot in (robot for robot in ROBOTS if robot.name in arguments.robots):
        of_robot: list[dict[str, Any]] = []
        for scene in arguments.scenes:
            found = []
            for problem in problems(robot, scene, arguments.count):
                found.append(measure(problem, arguments.repeats, arguments.time_limit))
                print(f"\r{robot.name} {scene} {len(found)}", end="", flush=True)
            print("\r" + line(f"{robot.name} {scene}", found), flush=True)
            of_robot += found
        print(line(f"{robot.name} all", of_robot), flush=True)
        rows += of_robot
    _OUT.parent.mkdir(exist_ok=True)
    _OUT.write_text(json.dumps({"rows": rows, "seconds": time.perf_counter() - begin}, indent=1))


if __name__ == "__main__":
    main()
