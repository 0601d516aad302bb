"""An arm on its way to a goal; a ball comes into the way, and the arm goes around it without a stop.

python examples/replanning.py            (needs the extra `online`)
"""

from typing import Any

import numpy as np

import manyhands as mh
from manyhands import planning
from manyhands.planning.replanning import Replan, replan

HAND = "panda_grasptarget"
LIMITS: dict[str, Any] = {"acceleration": 5.0, "jerk": 100.0}
START, GOAL = ([turn, 0.2, 0, -2.0, 0, 2.2, 0.785] for turn in (-1.2, 1.2))
SEEN = 0.1  # [s] when the ball comes
BALL, RADIUS = np.array([0.52, 0.3, 0.3]), 0.08  # [m]


def points_of_ball(count: int = 400) -> np.ndarray:
    """(count, 3) points all over the ball, as a camera might see them [m]."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    return BALL + RADIUS * directions / np.linalg.norm(directions, axis=1, keepdims=True)


def on_the_way(planner: planning.Planner) -> planning.Trajectory:
    """The motion to the goal before the ball comes."""
    plan = planner.plan(GOAL, start=START)
    return plan.trajectory(acceleration=LIMITS["acceleration"])


def avoid(planner: planning.Planner, motion: planning.Trajectory, time_limit: float = 0.15) -> Replan:
    """The motion from where the arm is when it sees the ball."""
    return replan(planner.with_cloud(points_of_ball()), motion, SEEN, GOAL, **LIMITS, time_limit=time_limit)


def main() -> None:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.add_plane("floor")
    planner = planning.Planner(world, HAND)
    motion = on_the_way(planner)
    blocked = planner.with_cloud(points_of_ball()).free_until(motion, SEEN)
    print(f"the ball comes at {SEEN:.2f} s; the arm would hit it at {blocked:.2f} s")
    found = avoid(planner, motion)
    print(f"{found.status}: {found.message}, found in {1e3 * found.took:.0f} ms")
    if not found.success:
        return
    speed = np.linalg.norm(found.motion.sample(np.linspace(0, found.join, 1000)).v, axis=1)
    print(f"joins the new way after {found.join:.2f} s, never slower than {speed.min():.2f} rad/s until then")
    print(f"{SEEN + found.motion.duration:.2f} s in all; {motion.duration:.2f} s without the ball")


if __name__ == "__main__":
    main()
