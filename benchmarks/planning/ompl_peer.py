"""OMPL's RRT-Connect on the same problems, with our collision checks, called back through Python.

By itself it looks at configurations along a way, at a hundredth of the space's extent; or it asks whether a whole way
is free, as our planner does. `pip install manyhands[peers]`.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.planning.scenes import Problem

Array = NDArray[np.float64]
VARIANTS = {"OMPL, its looks": False, "OMPL, our ways": True}


def is_installed() -> bool:
    try:
        import ompl  # noqa: F401  # pyright: ignore[reportMissingImports]
    except ImportError:
        return False
    return True


def plan(problem: Problem, time_limit: float, whole_ways: bool) -> dict[str, Any]:
    """Times [s], length and least distance [m] of a plan, as `measure` has them."""
    from ompl import base, geometric, util  # pyright: ignore[reportMissingImports]

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(problem.number + 1)
    planner: Any = problem.planner._core
    lower, upper = np.asarray(planner.lower), np.asarray(planner.upper)
    n = len(lower)

    def row(state: Any) -> Array:
        return np.array([state[i] for i in range(n)])

    class Ways(base.MotionValidator):
        def checkMotion(self, a: Any, b: Any) -> bool:  # noqa: N802
            return planner.is_way_free(row(a).astype(np.float32), row(b).astype(np.float32))

    space = base.RealVectorStateSpace(n)
    bounds = base.RealVectorBounds(n)
    for i in range(n):
        bounds.setLow(i, float(lower[i]))
        bounds.setHigh(i, float(upper[i]))
    space.setBounds(bounds)
    setup = geometric.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: bool(planner.are_free(row(state)[None])[0]))
    info = setup.getSpaceInformation()
    if whole_ways:
        info.setMotionValidator(Ways(info))
    ends = []
    for q in (problem.start, problem.goal):
        state: Any = info.allocState()
        for i in range(n):
            state[i] = float(q[i])
        ends.append(state)
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(geometric.RRTConnect(info))
    setup.setup()
    search = _seconds(lambda: setup.solve(time_limit))
    if not setup.haveExactSolutionPath():
        return {"solved": False, "search": search, "shorten": 0.0, "length": None, "distance": None}
    shorten = _seconds(lambda: setup.simplifySolution(time_limit))
    path = setup.getSolutionPath()
    waypoints = np.array([row(state) for state in path.getStates()])
    return {
        "solved": True,
        "search": search,
        "shorten": shorten,
        "length": float(np.linalg.norm(np.diff(waypoints, axis=0), axis=1).sum()),
        "distance": problem.planner.least_distance(waypoints).distance,
    }


def _seconds(work: Callable[[], Any]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin
