"""Ways by optimisation: free by Coal's own distances, smooth, the same for the same seed; and why there is none."""

import signal
import threading
import time

import coal
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

import manyhands as mh
from manyhands import planning

Array = NDArray[np.float64]
HAND = "panda_grasptarget"
HOME = np.array([0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03, 0.03])
POST, BOX = (0.45, 0.0, 0.4), (0.5, 0.5, 0.1)


def scene() -> mh.World:
    world = mh.World.from_file(mh.asset_path("panda/panda.urdf"))
    world.q = HOME
    world.add_cylinder("post", 0.05, 0.4, position=POST, fixed=True)
    world.add_box("box", (0.1, 0.2, 0.1), position=BOX, fixed=True)
    return world


@pytest.fixture(scope="module")
def planner() -> planning.Planner:
    return planning.Planner(scene(), HAND)


class Judge:
    """Pinocchio's kinematics and Coal's distances of the Panda's own file from the post and the box."""

    def __init__(self) -> None:
        path = mh.asset_path("panda/panda.urdf")
        self.model = pin.buildModelFromUrdf(str(path))
        self.geometry = pin.buildGeomFromUrdf(
            self.model, str(path), pin.GeometryType.COLLISION, package_dirs=str(path.parent)
        )
        still = [(coal.Cylinder(0.05, 0.8), POST), (coal.Box(0.2, 0.4, 0.2), BOX)]
        moving = len(self.geometry.geometryObjects)
        for i, (shape, position) in enumerate(still):
            placed = pin.SE3(np.eye(3), np.array(position))
            number = self.geometry.addGeometryObject(pin.GeometryObject(f"still {i}", 0, placed, shape))
            for k in range(moving):
                self.geometry.addCollisionPair(pin.CollisionPair(k, number))
        self.data, self.looks = self.model.createData(), self.geometry.createData()

    def least_distance(self, rows: Array) -> float:
        least = np.inf
        for row in rows:
            q = np.concatenate([row, HOME[7:]])
            pin.computeDistances(self.model, self.data, self.geometry, self.looks, q)
            least = min(least, *(found.min_distance for found in self.looks.distanceResults))
        return least


def by_millimetres(curve: planning.Trajectory) -> Array:
    """Points of a curve so near to each other that no point of the arm, which is 1.2 m long, moves by more than 1 mm
    or so where joints do not add up."""
    return curve.sample(np.linspace(0, curve.duration, int(1200 * curve.duration) + 2)).q


def ends(planner: planning.Planner, count: int) -> list[tuple[Array, Array]]:
    """Configurations to both sides of the post."""
    lower, upper = np.array([getattr(planner._core, name) for name in ("lower", "upper")])
    rows = np.random.default_rng(3).uniform(lower, upper, (4000, len(lower)))
    rows = rows[planner.is_free(rows)]
    hands = mh.kinematics.forward(planner.model, planner.configuration(rows), HAND)[0]
    low = (hands[:, 0] > 0.3) & (hands[:, 2] > 0) & (hands[:, 2] < 0.7)
    left, right = rows[low & (hands[:, 1] > 0.15)], rows[low & (hands[:, 1] < -0.15)]
    return list(zip(left[:count], right[:count], strict=True))


@pytest.mark.parametrize("way", ["optimize", "plan"])
def test_curves_are_free_at_every_millimetre_and_smooth(planner: planning.Planner, way: str) -> None:
    judge, solved = Judge(), 0
    for start, goal in ends(planner, 6):
        if way == "plan":
            plan = planner.plan(goal, start=start, smooth=True, time_limit=20)
            assert plan.success, plan.message
        else:
            plan = planner.optimize(goal, start=start, time_limit=20)
        if plan.cost is None or plan.curve is None:
            continue
        solved += 1
        assert judge.least_distance(by_millimetres(plan.curve)) > 0
        assert planner.least_distance(plan.waypoints).distance > 0
        q, _, a = plan.curve.sample(np.linspace(0, plan.curve.duration, 5000))
        assert np.allclose(q[[0, -1]], [start, goal], atol=1e-9)
        assert np.array_equal(plan.waypoints[[0, -1]], [start, goal])
        lower, upper = np.array([getattr(planner._core, name) for name in ("lower", "upper")])
        assert (q >= lower - 1e-6).all() and (q <= upper + 1e-6).all()
        assert np.abs(np.diff(a, axis=0)).max() < 0.01 * np.abs(a).max() + 1e-6  # no jumps, as parabolas have them
        assert plan.length == pytest.approx(plan.curve.duration, rel=0.02)
    assert solved >= 5


def test_optimised_motions_are_sooner_there_than_shortened_ones(planner: planning.Planner) -> None:
    durations = []
    for seed, (start, goal) in enumerate(ends(planner, 6)):
        plans = [planner.plan(goal, start=start, seed=seed, time_limit=20, smooth=smooth) for smooth in (False, True)]
        assert plans[0].cost is None
        durations.append([plan.trajectory(acceleration=5.0).duration for plan in plans])
    short, smooth = np.mean(durations, axis=0)
    assert smooth < 0.95 * short


def test_a_seed_decides_and_a_pose_is_reached(planner: planning.Planner) -> None:
    options = {"position": (0.4, -0.35, 0.35), "quaternion": (1.0, 0.0, 0.0, 0.0), "time_limit": 20.0}
    plans = [planner.optimize(**options, seed=5) for _ in range(2)]  # type: ignore[arg-type]
    assert plans[0].success, plans[0].message
    assert plans[0].cost == plans[1].cost and np.array_equal(plans[0].waypoints, plans[1].waypoints)
    p, _ = mh.kinematics.forward(planner.model, planner.configuration(plans[0].waypoints[-1]), HAND)
    assert np.allclose(p, options["position"], atol=1e-4)


def behind_a_wall() -> tuple[planning.Planner, Array, Array]:
    """A start and a goal to both sides of a wall that leaves too little room at the arm's axis."""
    world = scene()
    eighth = (0, 0, np.sin(np.pi / 8), np.cos(np.pi / 8))
    world.add_box("wall", (1, 0.01, 1), position=(0.806, 0.806, 1), quaternion=eighth, fixed=True)
    planner = planning.Planner(world, HAND)
    start, goal = planner.start.copy(), planner.start.copy()
    start[0], goal[0] = -0.8, 2.4
    return planner, start, goal


def test_what_cannot_be_is_said(planner: planning.Planner) -> None:
    stay = planner.optimize(planner.start)
    assert stay.success and stay.curve is None and len(stay.waypoints) == 1
    bad = planner.start.copy()
    bad[3] = 0.5
    assert planner.optimize(bad).status == "goal outside limits"
    assert planner.optimize(planner.start + 0.1, time_limit=0).status == "time limit"
    walled, start, goal = behind_a_wall()
    blocked = walled.optimize(goal, start=start, seeds=8, time_limit=30)
    assert blocked.status == "seeds blocked" and "none of 8 paths" in blocked.message
    assert "'wall'" in blocked.message and not blocked.success and len(blocked.waypoints) == 0
    for arguments, message in (
        ({"seeds": 0}, "seeds"),
        ({"clearance": 0.0}, "clearance"),
        ({"time_limit": -1.0}, "limit"),
    ):
        with pytest.raises(ValueError, match=message):
            planner.optimize(planner.start, **arguments)  # type: ignore[arg-type]


def test_time_limits_are_kept_and_ctrl_c_ends_it() -> None:
    walled, start, goal = behind_a_wall()
    begin = time.perf_counter()
    assert walled.optimize(goal, start=start, seeds=4096, time_limit=0.2).status == "time limit"
    assert time.perf_counter() - begin < 5
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        walled.optimize(goal, start=start, seeds=4096, time_limit=60)
    timer.join()
