"""A camera sees things on the floor; grasps and ways are planned for what it saw, and an arm puts them into a bin.

python examples/pick_and_place.py
"""

import numpy as np

import manyhands as mh
from manyhands import kinematics, perception, planning

TOOL, JAW, MARGIN = "arm/gripper/tool", "arm/gripper/jaw_joint", 0.005  # MARGIN is kept from everything [m]
READY = np.array([np.pi / 2, 0.1, 1.7, -0.23, -np.pi / 2, 0.0])  # the hand is above the bin


def station() -> mh.World:
    world = mh.World()
    world.add_plane("floor")
    world.add(mh.robots.load("bin"), [0, 0.52, 0], name="bin")
    world.add(mh.robots.load("six_axis", gripper="parallel"), name="arm")
    world.q = [*READY, 0, 0]
    return world


def see(world: mh.World) -> mh.World:
    """The station with boxes around what a camera above sees, down to the floor. What is held may touch that, and
    keeps the margin from a ground a little below."""
    camera = mh.Camera.perspective(640, 480, 0.8).look_at([0.5, 0, 1.2], [0.5, 0, 0], [1, 0, 0])
    points = world.render(camera).point_cloud()
    points = points[(np.abs(points - [0.5, 0, 0.105]) < [0.25, 0.3, 0.1]).all(axis=1)]
    cluster, seen = perception.dbscan(points * [1, 1, 0], 0.01), station()
    seen.add_plane("ground", position=[0, 0, -MARGIN - 1e-3])
    for k in range(cluster.max(initial=-1) + 1):
        p, r, half = perception.oriented_box(points[cluster == k])
        high = p[2] + half[2]
        seen.add_box(f"thing{k}", [*half[:2], high / 2], 0.1, [*p[:2], high / 2], r)
    return seen


def plan_pick(seen: mh.World) -> list[planning.Plan]:
    """Above a thing, down to it, and with it to the bin; nothing if no way is found."""
    planner, things = planning.Planner(seen, TOOL, margin=MARGIN), {name for name in seen.names if "thing" in name}
    drop = READY + 0.15 * (len(things) % 3 - 1) * np.eye(6)[0]  # side by side
    for thing in sorted(things):
        found = planning.grasps_in(seen, thing, obstacles=["floor", *(things - {thing})], tilt=0.6)
        for p, r in zip(found.position[:20], found.quaternion[:20], strict=True):
            above = planner.plan(position=p - 0.1 * kinematics.matrix(p, r)[:3, 2], quaternion=r)
            down = planner.plan(position=p, quaternion=r, start=above.waypoints[-1]) if above.success else above
            if down.success:
                q, held = planner.configuration(down.waypoints[-1]), {thing: "arm/gripper/palm"}
                carrier = planning.Planner(
                    seen.model, TOOL, q=q, attached=held, allowed=[(thing, "floor")], margin=MARGIN
                )
                away = carrier.plan(drop)
                if away.success:
                    return [above, down, away]
    return []


def follow(world: mh.World, plan: planning.Plan, jaw: float) -> None:
    """Along a plan, then the jaw to where it is wanted [m]."""
    motion = plan.trajectory(acceleration=4.0)
    for t in np.arange(0, motion.duration + 0.1, world.time_step):
        world.move(dict(zip(plan.joints, motion.sample(t + world.time_step).q, strict=True)), kp=1.0)
        world.step()
    world.move({JAW: jaw})
    world.step(150)


def clear(world: mh.World, most: int = 10) -> None:
    """Puts one thing after the other into the bin, until nothing that is seen can be reached."""
    for _ in range(most):
        plans = plan_pick(see(world))
        if not plans:
            return
        for plan, jaw in zip(plans, (0.0, 0.04, 0.0), strict=True):  # open, closed, open
            follow(world, plan, jaw)


if __name__ == "__main__":
    before = station()
    before.add_box("brick", [0.02, 0.04, 0.03], 0.2, [0.45, 0.1, 0.03])
    before.add_cylinder("can", 0.025, 0.04, 0.2, [0.5, -0.15, 0.04])
    clear(before)
    print({name: before.body_pose(name)[0].round(2).tolist() for name in ("brick", "can")})
