"""An arm carries a cup around a post and keeps it upright.

python examples/upright_cup.py
"""

import numpy as np

import manyhands as mh
from manyhands import planning

HAND = "panda_grasptarget"
WITHIN = 0.1  # [rad]
LEFT, RIGHT = ((turn, 0.2, 0, -2.0, 0, 2.2, 0.785) for turn in (0.6, -0.6))


def scene() -> mh.World:
    """A Panda with a cup in its hand, beside a post."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = [*LEFT, 0.03, 0.03]
    world.add_plane("floor")
    world.add_cylinder("post", 0.04, 0.35, position=(0.6, 0, 0.35), fixed=True)
    world.add_cylinder("cup", 0.025, 0.06, position=world.body_pose(HAND)[0])
    return world


def most_tilt(planner: planning.Planner, motion: planning.Trajectory, count: int = 5000) -> float:
    """The greatest angle of the hand from straight down [rad], by forward kinematics at many times."""
    rows = motion.sample(np.linspace(0, motion.duration, count)).q
    position, quaternion = mh.kinematics.forward(planner.model, planner.configuration(rows), HAND)
    down = -mh.kinematics.matrix(position, quaternion)[:, 2, 2]
    return float(np.arccos(np.clip(down, -1, 1)).max())


def main() -> None:
    planner = planning.Planner(scene(), HAND, attached={"cup": "panda_hand"})
    for keep, name in ((planning.upright("cup", within=WITHIN), "upright"), ((), "as it likes")):
        plan = planner.plan(RIGHT, keep=keep, time_limit=5.0)
        motion = plan.trajectory(acceleration=5.0)
        tilt = most_tilt(planner, motion)
        apart = planner.least_distance(plan.waypoints).distance
        print(
            f"{name}: found in {1e3 * (plan.search_time + plan.shorten_time):.0f} ms, takes {motion.duration:.2f} s, "
            f"tilts by {tilt:.3f} rad at most, never nearer to anything than {1e3 * apart:.1f} mm"
        )


if __name__ == "__main__":
    main()
