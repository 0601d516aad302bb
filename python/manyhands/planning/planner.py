"""Ways among obstacles: what is free, and plans from a configuration to a goal."""

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, World
from manyhands._core import planning as _core
from manyhands.arguments import cloud_rows, finite_row, finite_rows, instance, listed, number, whole_number
from manyhands.planning.constraints import PathConstraint, as_rows
from manyhands.planning.scene import names, state_of
from manyhands.planning.timing import time_optimal
from manyhands.planning.trajectories import Trajectory, limit_row, standing
from manyhands.rigid_motions import unit_quaternions

Array = NDArray[np.float64]
PlanStatus: TypeAlias = Literal[
    "solved",
    "start outside limits",
    "start collides",
    "goal outside limits",
    "goal collides",
    "start breaks constraint",
    "goal breaks constraint",
    "goal unreachable",
    "seeds blocked",
    "time limit",
]

_GOALS = 4  # configurations that reach a pose: the nearest
_LARGEST_SEED = 2**63 - 1


class Encounter(NamedTuple):
    """Two links that may not touch, and how far apart they are."""

    distance: float
    """[m]; negative where they overlap"""
    link_a: str
    link_b: str
    """"cloud" for points of a cloud"""


class Plan:
    """What `Planner.plan` found. Rows are of the n planned joints, in the order of `joints`."""

    __slots__ = (
        "_limits",
        "cost",
        "curve",
        "iterations",
        "joints",
        "message",
        "nodes",
        "search_time",
        "shorten_time",
        "status",
        "waypoints",
    )

    status: PlanStatus
    message: str
    """in a sentence: which joint is outside of limits, which links collide"""
    joints: tuple[str, ...]
    waypoints: Array
    """(m, n) from the start to the goal; none unless `success`. Straight lines between them are free all along."""
    curve: Trajectory | None
    """the same way with its corners blended, by its length; free all along. None where there is nowhere to go: without
    `success`, and where the start is the goal."""
    nodes: int
    """of both trees"""
    iterations: int
    """samples that were drawn"""
    search_time: float
    """[s] of the search alone"""
    shorten_time: float
    """[s] of shortcuts, and of blends or smoothing"""
    cost: float | None
    """what an optimised curve costs: its smoothness, and what is near it; None of others"""

    def __init__(self, joints: tuple[str, ...], velocity: Array, found: tuple[Any, ...]) -> None:
        self.joints, self._limits = joints, velocity
        self.status, self.message, self.waypoints, curve = found[:4]
        self.nodes, self.iterations, self.search_time, self.shorten_time, self.cost = found[4:]
        self.curve = None if curve is None else Trajectory._of(curve)

    @property
    def success(self) -> bool:
        """Whether there are waypoints: the status is "solved"."""
        return self.status == "solved"

    @property
    def length(self) -> float:
        """Of the waypoints' lines, in the space of the planned joints."""
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())

    def trajectory(
        self, *, acceleration: ArrayLike, velocity: ArrayLike | None = None, intervals: int = 200
    ) -> Trajectory:
        """The fastest motion along the curve within limits, (n,) or one for all: `time_optimal`. velocity: by default
        that of the model. Where the start is the goal it stands still for a millisecond. Raises ValueError without
        `success`."""
        if not self.success:
            raise ValueError(f"there is no way to follow: {self.message}")
        limits = self._limits if velocity is None else limit_row("velocity", velocity, len(self.joints))
        most = limit_row("acceleration", acceleration, len(self.joints))
        if self.curve is None:
            return standing(self.waypoints[0])
        return time_optimal(self.curve, velocity=limits, acceleration=most, intervals=intervals)

    def __repr__(self) -> str:
        return f"Plan({self.status!r}, {len(self.waypoints)} waypoints)" if self.success else f"Plan({self.message!r})"


class Planner:
    """What moves and what stands in the way, as they are now: a later change of the world needs another planner.

    scene: a world, or a model with its configuration q (nq,), by default the initial one.
    frame: the joints that move it are planned. Or, in its place, joints: their names; each has one coordinate. All
    others stay.
    attached: links that are carried, by the link that carries each, as {"cube": "panda_hand"}. They move with it from
    where they are now, and may touch the links of the robot that they touch now.
    allowed: pairs of links that may touch, beside those that the model allows.
    cloud: points (m, 3) [m] that nothing comes nearer to than cloud_radius [m]. Those that are not finite, as cameras
    give where they see nothing, are left out; a cloud of none but such raises ValueError.
    margin: a distance that is kept from everything, and by the robot's links from each other [m].
    overshoot: how far the balls that stand for links stick out of them [m]: a matter of speed, not of what is free.
    """

    def __init__(
        self,
        scene: World | Model,
        frame: str | None = None,
        *,
        joints: Iterable[str] = (),
        q: ArrayLike | None = None,
        attached: Mapping[str, str] | None = None,
        allowed: Iterable[tuple[str, str]] = (),
        cloud: ArrayLike | None = None,
        cloud_radius: float = 0.01,
        margin: float = 0.0,
        overshoot: float = 0.02,
    ) -> None:
        model, now, mocap = state_of(scene, q)
        chosen = names("joints", joints)
        if frame is None and not chosen:
            raise ValueError("no joints are planned; name the frame that is to go somewhere, or joints")
        if frame is not None and chosen:
            raise ValueError(
                f"frame is {frame!r} and joints are {chosen}; give the frame to plan all joints that move it, "
                "or joints alone to plan just these"
            )
        self.model = model
        self.frame = None if frame is None else instance("frame", frame, str)
        radius = number("cloud_radius", cloud_radius, least=0)
        points = [] if cloud is None else [(_points("cloud", cloud), radius)]
        carried = instance("attached", {} if attached is None else attached, Mapping, hint='as {"cube": "panda_hand"}')
        pairs = [_pair("attached", pair) for pair in carried.items()]
        may_touch = [_pair("allowed", pair) for pair in listed("allowed", allowed, tuple, list)]
        margin, overshoot = number("margin", margin, least=0), number("overshoot", overshoot, above=0)
        self._core = _core.Planner(model, now, mocap, frame or "", chosen, pairs, may_touch, points, margin, overshoot)

    @property
    def joints(self) -> tuple[str, ...]:
        """(n,) the names of the planned joints, in the order of q."""
        return tuple(self._core.joints)

    @property
    def start(self) -> Array:
        """(n,) where the planned joints are in the scene."""
        return np.asarray(self._core.start)

    @property
    def self_pairs(self) -> list[tuple[str, str]]:
        """Links that move and are kept from each other: those that planned joints could bring as near as the margin."""
        return list(self._core.pairs)

    def configuration(self, planned: ArrayLike) -> Array:
        """q (..., nq) of the model at planned joints (..., n); everything else as it is in the scene."""
        rows = finite_rows("planned", planned, len(self.joints))
        flat = [self._core.configuration(row) for row in rows.reshape(-1, len(self.joints))]
        return np.array(flat).reshape(*rows.shape[:-1], self.model.nq)

    def is_free(self, planned: ArrayLike) -> NDArray[np.bool_]:
        """Whether nothing collides (...) at planned joints (..., n), by exact distances where balls leave doubts.
        Limits of joints are not looked at; `plan` and `free_until` do."""
        rows = finite_rows("planned", planned, len(self.joints))
        return np.asarray(self._core.are_free(_flat(rows))).reshape(rows.shape[:-1])

    def is_way_free(self, a: ArrayLike, b: ArrayLike) -> bool:
        """Whether nothing collides anywhere on the straight line from a to b (n,). A way within half a millimetre of
        an obstacle may count as blocked. Limits of joints are not looked at."""
        return self._core.is_way_free(*(self._row(name, q).astype(np.float32) for name, q in (("a", a), ("b", b))))

    def nearest(self, planned: ArrayLike) -> Encounter:
        """The two links that are nearest to touching at planned joints (n,), of those that may not; by exact distances
        of all shapes, whatever the margin."""
        return Encounter(*self._core.nearest(self._row("planned", planned)))

    def least_distance(self, waypoints: ArrayLike, step: float = 0.001) -> Encounter:
        """The same on the way along waypoints (m, n), looked at so often that no point moves by more than step [m]
        from one look to the next: an independent judge of plans."""
        rows = finite_rows("waypoints", waypoints, len(self.joints))
        if rows.ndim != 2 or len(rows) == 0:
            raise ValueError(f"waypoints have shape {rows.shape}; expected (m, {len(self.joints)}), m above 0")
        return Encounter(*self._core.least_distance(_flat(rows), number("step", step, above=0, infinite=True)))

    def free_until(
        self, motion: Trajectory, start: float = 0.0, *, keep: PathConstraint | Sequence[PathConstraint] = ()
    ) -> float:
        """The time [s] up to which a motion of the planned joints is free all along from `start` on, within limits and
        what `keep` asks: its duration if it is to the end. To a millisecond, and rather too early: what passes within
        half a millimetre of an obstacle may count as blocked."""
        moves = instance("motion", motion, Trajectory, hint="as Plan.trajectory makes one")
        return self._core.free_until(moves._motion, number("start", start), *as_rows(keep))

    def with_cloud(self, points: ArrayLike, radius: float = 0.01) -> "Planner":
        """A planner of the same scene with points (m, 3) [m] in it that nothing comes nearer to than radius [m], as
        `cloud`: found in a millisecond, as all else is known. Points that are not finite are left out, as there."""
        more = copy.copy(self)
        more._core = self._core.with_cloud(_points("points", points), number("radius", radius, least=0))
        return more

    @property
    def velocity(self) -> Array:
        """(n,) the model's limits of velocity [rad/s or m/s]."""
        return np.asarray(self._core.velocity)

    def balls(self, planned: ArrayLike) -> Array:
        """(m, 4) the balls that stand for what moves: centre and radius [m]."""
        return np.asarray(self._core.balls(self._row("planned", planned)))

    def plan(
        self,
        goal: ArrayLike | None = None,
        *,
        position: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        start: ArrayLike | None = None,
        keep: PathConstraint | Sequence[PathConstraint] = (),
        time_limit: float = 1.0,
        seed: int = 0,
        shorten: bool = True,
        smooth: bool = False,
        blend: float = 0.5,
        range: float = 2.0,
    ) -> Plan:
        """A way from `start` (n,), by default where the scene is, to a goal.

        goal: planned joints (n,), or several goals (m, n) of which one is to be reached. Or position (3,) and
        quaternion (4,) xyzw of the planner's frame. keep: constraints that hold all along the way, as `upright("cup")`,
        start and goal included. time_limit [s]: kept. seed: the same seed gives the same plan, unless time runs out.
        shorten: cut corners. smooth: make the curve one that is twice continuously differentiable, by optimisation;
        where none of what comes of it is free, corners are blended. blend: how far from a corner the curve may leave it
        [rad or m]. range: the longest edge of the search.

        What cannot be solved is said by the plan's `status` and `message`. Ctrl-C ends the search. Raises ValueError on
        arrays that do not fit and NaN.
        """
        constraints = as_rows(keep)
        corner, longest = number("blend", blend, least=0), number("range", range, above=0)

        def search(begin: Array, goals: Array, drawn: int) -> tuple[Any, ...]:
            return self._core.plan(begin, goals, time_limit, shorten, smooth, corner, longest, drawn, *constraints)

        return self._plan(search, goal, position, quaternion, start, time_limit, seed)

    def optimize(
        self,
        goal: ArrayLike | None = None,
        *,
        position: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        start: ArrayLike | None = None,
        seeds: int = 16,
        clearance: float = 0.02,
        time_limit: float = 1.0,
        seed: int = 0,
    ) -> Plan:
        """A smooth way by optimisation, without a search: `seeds` paths, the first straight to each goal, the others
        along arcs past random configurations, slide to where they cost least, all at once. Of those that are proven
        free the best is taken. Its `curve` is a cubic spline, and `waypoints` are points of it.

        clearance: from where on it costs to be near an obstacle [m]; less is free, too. All else as of `plan`. Where
        the status is "seeds blocked" no path is free, and `plan(smooth=True)` may find one.
        """
        count, kept = whole_number("seeds", seeds, 1, 4096), number("clearance", clearance, above=0)

        def descend(begin: Array, goals: Array, drawn: int) -> tuple[Any, ...]:
            return self._core.optimize(begin, goals, time_limit, count, kept, drawn)

        return self._plan(descend, goal, position, quaternion, start, time_limit, seed)

    def _plan(
        self,
        find: Callable[[Array, Array, int], tuple[Any, ...]],
        goal: Any,
        position: Any,
        quaternion: Any,
        start: ArrayLike | None,
        time_limit: float,
        seed: int,
    ) -> Plan:
        begin = self.start if start is None else self._row("start", start)
        drawn = whole_number("seed", seed, 0, _LARGEST_SEED)
        seconds = number("time_limit", time_limit, least=0, infinite=True)
        goals, pose = self._goal_of(goal, position, quaternion)
        status = message = ""
        if pose is not None:
            goals, status, message = self._core.goals(self.frame, *pose, begin, _GOALS, drawn, seconds)
        found: Any = (status, message, goals, None, 0, 0, 0.0, 0.0, None)
        if len(goals) > 0:
            found = find(begin, goals, drawn)
        return Plan(self.joints, self.velocity, found)

    def _goal_of(
        self, goal: ArrayLike | None, position: ArrayLike | None, quaternion: ArrayLike | None
    ) -> tuple[Array, tuple[Array, Array] | None]:
        """Goals (m, n) as `plan` is given them, or none and the pose. Raises ValueError on what is no goal."""
        if (goal is None) == (position is None) or (position is None) != (quaternion is None):
            raise ValueError("give either goal, or position and quaternion")
        if goal is not None:
            rows = finite_rows("goal", goal, len(self.joints))
            if rows.ndim > 2 or rows.size == 0:
                raise ValueError(f"goal has shape {rows.shape}; expected ({len(self.joints)},) or rows of it")
            return _flat(rows), None
        if self.frame is None:
            raise ValueError("a pose is that of a frame; make the planner with one")
        p, r = finite_row("position", position, 3), finite_row("quaternion", quaternion, 4)
        return np.zeros((0, len(self.joints))), (p, unit_quaternions("quaternion", r))

    def _row(self, name: str, values: ArrayLike) -> Array:
        return np.ascontiguousarray(finite_row(name, values, len(self.joints)))


def plan(scene: World | Model, frame: str, goal: ArrayLike | None = None, **options: Any) -> Plan:
    """`Planner.plan` of a planner that is used once: options are those of both."""
    of_plan = ("position", "quaternion", "start", "keep", "time_limit", "seed", "shorten", "smooth", "blend", "range")
    chosen = {name: options.pop(name) for name in of_plan if name in options}
    return Planner(scene, frame, **options).plan(goal, **chosen)


def _points(name: str, cloud: ArrayLike) -> Array:
    points = cloud_rows(name, cloud)
    seen = points[np.isfinite(points).all(axis=1)]
    if len(points) > 0 and len(seen) == 0:
        raise ValueError(f"{name} has {len(points)} points, and none is finite; where nothing is seen, give no points")
    return np.ascontiguousarray(seen)


def _pair(name: str, given: Any) -> tuple[str, str]:
    """Two names of links."""
    pair = listed(f"a pair of {name}", given, str)
    if len(pair) != 2:
        raise ValueError(f"a pair of {name} is {given}; expected two names of links")
    return pair[0], pair[1]


def _flat(rows: Array) -> Array:
    return np.ascontiguousarray(rows.reshape(-1, rows.shape[-1]))
