"""Two Pandas in one world: the left one picks up a bar and hands it to the right one, which carries it away.

python examples/two_arms.py
"""

from collections.abc import Sequence

import numpy as np

import manyhands as mh

ARMS = {"left": ([-0.7, 0, 0], [0, 0, 0, 1], [1, 0, 0, 0]), "right": ([0.7, 0, 0], [0, 0, 1, 0], [0, 1, 0, 0])}
START = [0, -0.3, 0, -2.4, 0, 2.1, 0.79, 0.04, 0.04]
FORCES = [87, 87, 87, 87, 12, 12, 12, 40, 40]


class TwoArms:
    """The world, and where its motors are to go."""

    def __init__(self) -> None:
        self.world = mh.World()
        self.world.add_plane("floor")
        for name, (position, quaternion, _) in ARMS.items():
            self.world.add(mh.asset_path("panda/panda.urdf"), position, quaternion, name=name)
        self.world.add_box("bar", [0.16, 0.015, 0.015], mass=0.2, position=[-0.1, 0, 0.015], friction=1.0)
        joints = [joint for joint in self.world.model.joints if joint.nv == 1]  # of arms, fingers last
        self.in_q = {arm: [joint.iq for joint in joints if joint.name.startswith(f"{arm}/")] for arm in ARMS}
        self.in_v = {arm: [joint.iv for joint in joints if joint.name.startswith(f"{arm}/")] for arm in ARMS}
        self.target, self.force = self.world.q.copy(), np.zeros(self.world.model.nv)
        for arm in ARMS:
            self.target[self.in_q[arm]] = START
            self.force[self.in_v[arm]] = FORCES
        self.world.q = self.target

    def grip(self, arm: str, width: float, steps: int = 150) -> None:
        """Moves the fingers to a width [m] within 300 ms."""
        goal = self.target.copy()
        goal[self.in_q[arm][-2:]] = width / 2
        self.go(goal, steps)

    def move(self, steps: int = 500, **hands: Sequence[float]) -> None:
        """Moves hands, which point down, to places [m] within a second, all at once."""
        goal = self.target
        for arm, position in hands.items():
            found = mh.inverse_kinematics(
                self.world.model, f"{arm}/panda_grasptarget", position, ARMS[arm][2], start=goal, restarts=0
            )
            if not found.success:
                raise RuntimeError(f"the {arm} hand cannot reach {position}")
            goal = found.q
        self.go(goal, steps)

    def go(self, goal: np.ndarray, steps: int) -> None:
        """Moves the motors' targets evenly to `goal` (nq), then waits as long as a fifth of that."""
        start, target = self.target, np.zeros_like(self.force)
        for share in np.minimum(np.linspace(0, 1.2, steps), 1):
            self.target = start + share * (goal - start)
            for arm in ARMS:
                target[self.in_v[arm]] = self.target[self.in_q[arm]]
            self.world.set_motors(target_q=target, max_force=self.force)
            self.world.step()


def held_by(world: mh.World) -> set[str]:
    """The arms whose fingers touch the bar."""
    links = {link for c in world.contacts() for link in (c.link_a, c.link_b) if "bar" in (c.link_a, c.link_b)}
    return {link.split("/")[0] for link in links if "finger" in link}


def hand_over() -> TwoArms:
    """Plays it to the end."""
    arms = TwoArms()
    arms.grip("right", 0.08)
    arms.move(left=[-0.2, 0, 0.015], right=[0.25, 0, 0.3])
    arms.grip("left", 0)
    arms.move(left=[-0.1, 0, 0.25])
    arms.move(right=[0.1, 0, 0.25])
    arms.grip("right", 0)
    print("held by", sorted(held_by(arms.world)), "at", arms.world.body_pose("bar")[0].round(3))
    arms.move(left=[-0.1, 0.1, 0.3], right=[0.1, 0.1, 0.3])  # together
    print("held by", sorted(held_by(arms.world)), "at", arms.world.body_pose("bar")[0].round(3))
    arms.grip("left", 0.08)
    arms.move(left=[-0.25, 0, 0.4], right=[0.2, -0.1, 0.2])
    print("held by", sorted(held_by(arms.world)), "at", arms.world.body_pose("bar")[0].round(3))
    return arms


if __name__ == "__main__":
    hand_over()
