"""Plans: what is free, by another way of looking; ways that are free all along; and why there is no plan."""

import itertools
import signal
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import planning

Array = NDArray[np.float64]
HAND = "panda_grasptarget"
HOME = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03])


def scene() -> mh.World:
    """A Panda before a post and a box, on a floor."""
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = HOME
    world.add_plane("floor", position=(0, 0, -0.01))
    world.add_cylinder("post", 0.05, 0.4, position=(0.45, 0, 0.4), fixed=True)
    world.add_box("box", (0.1, 0.2, 0.1), position=(0.5, 0.5, 0.1), fixed=True)
    return world


@pytest.fixture(scope="module")
def planner() -> planning.Planner:
    return planning.Planner(scene(), HAND)


def random_rows(planner: planning.Planner, count: int, seed: int) -> Array:
    lower, upper = np.array([getattr(planner._core, name) for name in ("lower", "upper")])
    return np.random.default_rng(seed).uniform(lower, upper, (count, len(planner.joints)))


def free_rows(planner: planning.Planner, count: int, seed: int) -> Array:
    rows = random_rows(planner, 20 * count, seed)
    return rows[planner.is_free(rows)][:count]


def least_distance(world: mh.World, planner: planning.Planner, row: Array) -> float:
    """Of the planner's pairs and the obstacles, by the world's own queries."""
    world.q = planner.configuration(row)
    moving = [f"panda_link{i}" for i in range(1, 8)] + ["panda_hand", "panda_leftfinger", "panda_rightfinger"]
    pairs = planner.self_pairs + [(a, b) for a in moving for b in ("post", "box")]
    pairs += [(a, "floor") for a in moving] + [(a, "panda_link0") for a in moving[1:]]
    found = [world.distance(a, b) for a, b in pairs]
    return min(d.phi for d in found if d is not None)


def test_free_is_what_the_world_calls_free(planner: planning.Planner) -> None:
    world, rows = scene(), random_rows(planner, 200, 1)
    is_free = planner.is_free(rows)
    assert 20 < is_free.sum() < 180
    for row, free in zip(rows, is_free, strict=True):
        distance = least_distance(world, planner, row)
        assert (distance > 0) == free
        assert planner.nearest(row).distance == pytest.approx(distance, abs=1e-9)


def test_a_way_is_free_if_and_only_if_nothing_on_it_collides(planner: planning.Planner) -> None:
    rows = free_rows(planner, 60, 2)
    found = {True: 0, False: 0}
    for a, b in itertools.pairwise(rows):
        b = a + 0.3 * (b - a)
        free, least = planner.is_way_free(a, b), planner.least_distance([a, b]).distance
        found[free] += 1
        assert least > 0 if free else least < 1e-3
    assert min(found.values()) > 5


def test_self_collisions_count(planner: planning.Planner) -> None:
    folded = np.array([0, 0, 0, -3.07, 0, 3.7, 0.0])
    world = scene()
    distance = least_distance(world, planner, folded)
    assert bool(planner.is_free(folded)) == (distance > 0)
    assert ("panda_link5", "panda_hand") in planner.self_pairs
    assert ("panda_leftfinger", "panda_rightfinger") not in planner.self_pairs  # no planned joint moves them


def plans(planner: planning.Planner, count: int) -> Iterator[planning.Plan]:
    rows = free_rows(planner, 2 * count, 3)
    for seed, (start, goal) in enumerate(zip(rows[::2], rows[1::2], strict=True)):
        plan = planner.plan(goal, start=start, time_limit=10, seed=seed)
        assert plan.success, plan.message
        assert np.array_equal(plan.waypoints[0], start) and np.array_equal(plan.waypoints[-1], goal)
        yield plan


def test_plans_and_their_motions_are_free_all_along_and_within_limits(planner: planning.Planner) -> None:
    for plan in plans(planner, 8):
        assert planner.least_distance(plan.waypoints).distance > 0
        motion = plan.trajectory(acceleration=5.0)
        q, v, a = motion.sample(np.linspace(0, motion.duration, 2000))
        assert planner.is_free(q).all()
        assert (np.abs(a) <= 5 * (1 + 1e-6)).all()
        assert (np.abs(v) <= np.array(planner._core.velocity) * (1 + 1e-6)).all()
        assert np.allclose(q[[0, -1]], plan.waypoints[[0, -1]], atol=1e-9)


def test_shortening_shortens_and_a_seed_decides(planner: planning.Planner) -> None:
    start, goal = free_rows(planner, 2, 5)
    long = planner.plan(goal, start=start, shorten=False, seed=4)
    short = planner.plan(goal, start=start, seed=4)
    assert short.length <= long.length + 1e-6
    assert np.array_equal(short.waypoints, planner.plan(goal, start=start, seed=4).waypoints)


def test_a_pose_is_reached(planner: planning.Planner) -> None:
    position, quaternion = (0.4, -0.35, 0.35), (1.0, 0.0, 0.0, 0.0)
    plan = planner.plan(position=position, quaternion=quaternion, time_limit=5)
    assert plan.success, plan.message
    p, r = mh.kinematics.forward(planner.model, planner.configuration(plan.waypoints[-1]), HAND)
    assert np.allclose(p, position, atol=1e-4) and abs(abs(np.dot(r, quaternion)) - 1) < 1e-6


def test_a_pose_out_of_reach_is_told_from_one_in_collision_and_from_no_time(planner: planning.Planner) -> None:
    down = (1.0, 0.0, 0.0, 0.0)
    far = planner.plan(position=(3, 0, 0), quaternion=down)
    assert far.status == "goal unreachable" and "out of reach" in far.message and HAND in far.message
    within = planner.plan(position=(0.45, 0, 0.4), quaternion=down)  # within the post
    assert within.status == "goal collides" and "post" in within.message and "overlap" in within.message
    late = planner.plan(position=(0.4, -0.35, 0.35), quaternion=down, time_limit=0)
    assert late.status == "time limit" and "no time was left" in late.message
    assert not (far.success or within.success or late.success) and within.waypoints.shape == (0, 7)


def test_a_start_that_collides_is_said_before_what_the_goal_is(planner: planning.Planner) -> None:
    """At the zeros a Panda's hand lies in its forearm; where it is there, that is no matter of the goal."""
    for position, quaternion in (mh.kinematics.forward(planner.model, np.zeros(9), HAND), ((3, 0, 0), (1, 0, 0, 0))):
        plan = planner.plan(position=position, quaternion=quaternion, start=np.zeros(7))
        assert plan.status == "start collides" and "'panda_link5' and 'panda_hand' overlap" in plan.message


def test_where_the_arm_is_already_the_motion_stands_still(planner: planning.Planner) -> None:
    plan = planner.plan(planner.start)
    assert plan.success and plan.curve is None
    motion = plan.trajectory(acceleration=5.0)
    q, v, a = motion.sample(np.linspace(0, motion.duration, 5))
    assert 0 < motion.duration < 0.01 and not v.any() and not a.any()
    np.testing.assert_array_equal(q, np.tile(planner.start, (5, 1)))
    with pytest.raises(ValueError, match="no way to follow: the goal collides"):
        planner.plan(np.zeros(7)).trajectory(acceleration=5.0)


def test_limits_are_no_matter_of_what_is_free_but_of_plans(planner: planning.Planner) -> None:
    beyond = planner.start + 2 * np.pi * np.eye(7)[0]
    assert planner.is_free(beyond) and planner.plan(beyond).status == "goal outside limits"


def test_ctrl_c_ends_a_search() -> None:
    world = scene()
    eighth = (0, 0, np.sin(np.pi / 8), np.cos(np.pi / 8))
    world.add_box("wall", (1, 0.01, 1), position=(0.806, 0.806, 1), quaternion=eighth, fixed=True)
    planner = planning.Planner(world, HAND)
    start, goal = planner.start.copy(), planner.start.copy()
    start[0], goal[0] = -0.8, 2.4  # to both sides of the wall, which leaves too little room at the arm's axis
    limit = 20.0
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    begin = time.perf_counter()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        planner.plan(goal, start=start, time_limit=limit)
    timer.join()
    assert time.perf_counter() - begin < limit / 2
    assert planner.plan(start, start=start).success


def test_what_cannot_be_is_said(planner: planning.Planner) -> None:
    bad = planner.start.copy()
    bad[3] = 0.5
    plan = planner.plan(bad)
    assert plan.status == "goal outside limits" and "panda_joint4" in plan.message
    assert planner.plan(planner.start, start=bad).status == "start outside limits"
    blocked = next(row for row in random_rows(planner, 100, 6) if not planner.is_free(row))
    for plan, status in ((planner.plan(blocked), "goal"), (planner.plan(planner.start, start=blocked), "start")):
        assert plan.status == f"{status} collides" and "overlap" in plan.message
        assert not plan.success and len(plan.waypoints) == 0
        with pytest.raises(ValueError, match="no way to follow"):
            plan.trajectory(acceleration=1.0)
    stay = planner.plan(planner.start)
    assert stay.success and stay.curve is None


def test_time_limits_are_kept() -> None:
    world = scene()
    for i, (x, y) in enumerate(((0.3, 0), (-0.3, 0), (0, 0.3), (0, -0.3))):  # the hand cannot leave
        world.add_box(f"wall {i}", (0.01 if x else 2, 0.01 if y else 2, 0.6), position=(x * 6, y * 6, 0.6), fixed=True)
    world.add_box("between", (0.3, 0.005, 0.7), position=(0.75, -0.25, 0.7), fixed=True)
    planner = planning.Planner(world, HAND)
    goal = planner.start.copy()
    goal[0] = 2.8
    begin = time.perf_counter()
    plan = planner.plan(goal, time_limit=0.2)
    assert time.perf_counter() - begin < 1.0
    assert plan.success or plan.status == "time limit"
    assert planner.plan(goal, time_limit=0.0).status == "time limit"


def test_what_is_held_goes_along() -> None:
    world = scene()
    hand, turn = world.body_pose(HAND)
    world.add_box("stick", (0.02, 0.02, 0.25), position=hand, quaternion=turn)
    free = planning.Planner(scene(), HAND)
    held = planning.Planner(world, HAND, attached={"stick": "panda_hand"})
    obstacle = planning.Planner(world, HAND)
    assert not obstacle.is_free(obstacle.start) and held.is_free(held.start)
    rows = random_rows(free, 300, 7)
    without, along = free.is_free(rows), held.is_free(rows)
    assert not (along & ~without).any() and (without & ~along).sum() > 10
    with pytest.raises(ValueError, match="fixed to the world"):
        planning.Planner(world, HAND, attached={"post": "panda_hand"})


def test_clouds_are_obstacles() -> None:
    bare = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    bare.q = HOME
    angle, height = np.meshgrid(np.linspace(0, 2 * np.pi, 40), np.linspace(0, 0.8, 80))
    cloud = np.stack([0.45 + 0.05 * np.cos(angle), 0.05 * np.sin(angle), height], axis=-1).reshape(-1, 3)
    cloud[0] = np.nan
    planner = planning.Planner(bare, HAND, cloud=cloud, cloud_radius=0.008)
    bare.add_cylinder("post", 0.05, 0.4, position=(0.45, 0, 0.4), fixed=True)
    post = planning.Planner(bare, HAND)
    rows = random_rows(post, 300, 8)
    blocked = ~post.is_free(rows)
    hits = [row for row in rows[blocked] if "post" in post.nearest(row) and post.nearest(row).distance < 0]
    assert len(hits) > 5 and not planner.is_free(np.array(hits)).any()
    start, goal = free_rows(planner, 2, 9)
    plan = planner.plan(goal, start=start, time_limit=5)
    assert plan.success and planner.least_distance(plan.waypoints).distance > 0


def test_an_empty_cloud_is_none() -> None:
    for cloud in ([], np.zeros((0, 3))):
        assert planning.Planner(scene(), HAND, cloud=cloud).is_free(HOME[:7])


def test_a_cloud_in_which_nothing_is_seen_is_refused(planner: planning.Planner) -> None:
    blind = np.full((5, 3), np.nan)
    with pytest.raises(ValueError, match="cloud has 5 points, and none is finite"):
        planning.Planner(scene(), HAND, cloud=blind)
    with pytest.raises(ValueError, match="points has 5 points, and none is finite"):
        planner.with_cloud(blind)


def test_margins_are_kept_once_and_nearest_does_not_know_them(planner: planning.Planner) -> None:
    rows = np.concatenate([HOME[None, :7], random_rows(planner, 200, 11)])
    nearest = [planner.nearest(row) for row in rows]
    for margin in (0.01, 0.02, 0.028, 0.03, 0.05, 0.3):
        wide = planning.Planner(scene(), HAND, margin=margin)
        assert [wide.nearest(row) for row in rows] == nearest
        free = wide.is_free(rows)
        assert np.array_equal(free, [found.distance > margin for found in nearest])
        assert free[0] == (margin < 0.0285)
        assert 10 < free.sum() < 190 or margin > 0.0285


def test_a_broken_margin_is_said_with_the_pair_that_breaks_it() -> None:
    wide = planning.Planner(scene(), HAND, margin=0.03)
    plan = wide.plan(wide.start + 0.1)
    assert plan.status == "start collides"
    expected = "'panda_link5' and 'panda_link7' are 0.0285258 m apart, less than the margin of 0.03 m"
    assert expected in plan.message


def test_pairs_that_can_overlap_are_looked_at_however_wide_the_margin(planner: planning.Planner) -> None:
    for margin in (0.03, 0.1, 0.3):
        assert set(planner.self_pairs) <= set(planning.Planner(scene(), HAND, margin=margin).self_pairs)


def test_pairs_may_be_allowed_and_a_margin_kept(planner: planning.Planner) -> None:
    rows = random_rows(planner, 200, 10)
    every = planning.Planner(scene(), HAND, allowed=[(link.name, "post") for link in planner.model.links])
    assert (every.is_free(rows) & ~planner.is_free(rows)).any()
    wide = planning.Planner(scene(), HAND, margin=0.05)
    for row, free in zip(rows, wide.is_free(rows), strict=True):
        assert free == (planner.nearest(row).distance > 0.05) or abs(planner.nearest(row).distance - 0.05) < 1e-6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"goal": np.full(7, np.nan)}, "must be finite"),
        ({"goal": np.zeros(5)}, "goal has shape"),
        ({}, "give either goal"),
        ({"goal": np.zeros(7), "time_limit": -1.0}, "time_limit"),
        ({"goal": np.zeros(7), "range": 0.0}, "range"),
        ({"goal": np.zeros(7), "seed": -1}, "seed"),
        ({"position": (0, 0, 1)}, "give either goal"),
    ],
)
def test_bad_arguments_are_refused(planner: planning.Planner, arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        planner.plan(**arguments)  # type: ignore[arg-type]


def test_bad_scenes_are_refused() -> None:
    world = scene()
    with pytest.raises(ValueError, match="no joints"):
        planning.Planner(world)
    with pytest.raises(ValueError, match="margin"):
        planning.Planner(world, HAND, margin=-1.0)
    with pytest.raises(ValueError, match="cloud has shape"):
        planning.Planner(world, HAND, cloud=np.zeros((3, 2)))
    with pytest.raises(KeyError):
        planning.Planner(world, "nobody")
    with pytest.raises(ValueError, match="or joints alone"):
        planning.Planner(world, HAND, joints=["panda_joint1"])
    assert planning.Planner(world, joints="panda_joint1").joints == ("panda_joint1",)
    with pytest.raises(TypeError, match="expected Model, or a World"):
        planning.Planner("panda.urdf", HAND)  # type: ignore[arg-type]
    world.add_box("loose", (0.1, 0.1, 0.1), position=(1, 1, 1))
    joint = next(joint.name for joint in world.model.joints if joint.type == "floating")
    with pytest.raises(ValueError, match="has 7 coordinates"):
        planning.Planner(world, joints=[joint])
