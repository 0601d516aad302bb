"""How many poses `manyhands.kinematics.inverse` solves, and how long it takes."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.ik.arms import TOLERANCE, Arm, Array, Poses, errors, solved
from manyhands import kinematics as kin
from manyhands._core import kinematics as _core

_NEARBY = 0.05  # [rad or m] from the solution, of starts as a controller has them
_PATIENCE = 10_000  # restarts of poses that the default did not solve


@dataclass(frozen=True)
class Figures:
    """Of one arm."""

    arm: str
    poses: int
    solved: int
    failures: list[dict[str, Any]]
    """of each pose that was not solved: its number, the nearest errors [m, rad], and whether more restarts solve it"""
    rate: float
    """solutions a second of processor time on one core, all poses in one call"""
    single: float
    """[s] median of single calls from the neutral configuration"""
    single_nearby: float
    """the same from a start near the solution"""
    core_nearby: float
    """the same without Python's checks: the extension's function alone"""


def measure(arm: Arm, poses: Poses, singles: int, repeats: int, advance: Callable[[], None]) -> Figures:
    """Calls `advance` after each of the repeats, and in the end. singles: how many poses are solved by themselves."""
    spent, found = [], None
    for _ in range(repeats):
        begin = time.process_time()
        found = _all_at_once(arm, poses)
        spent.append(time.process_time() - begin)
        advance()
    assert found is not None
    good = solved(arm, poses, found.q) & found.success
    of_singles = Poses(*(rows[:singles] for rows in (poses.q, poses.position, poses.quaternion)))
    figures = Figures(
        arm=arm.name,
        poses=len(poses.q),
        solved=int(good.sum()),
        failures=_failures(arm, poses, found.q, np.flatnonzero(~good)),
        rate=int(good.sum()) / min(spent),
        single=_median(_calls(arm, of_singles, None)),
        single_nearby=_median(_calls(arm, of_singles, _near(arm, of_singles))),
        core_nearby=_median(_core_calls(arm, of_singles, _near(arm, of_singles))),
    )
    advance()
    return figures


def _all_at_once(arm: Arm, poses: Poses, **options: Any) -> kin.IkResult:
    return kin.inverse(
        arm.model,
        arm.frame,
        position=poses.position,
        quaternion=poses.quaternion,
        position_tolerance=TOLERANCE,
        rotation_tolerance=TOLERANCE,
        **options,
    )


def _failures(arm: Arm, poses: Poses, q: Array, numbers: Any) -> list[dict[str, Any]]:
    if len(numbers) == 0:
        return []
    missed = Poses(poses.q[numbers], poses.position[numbers], poses.quaternion[numbers])
    again = _all_at_once(arm, missed, restarts=_PATIENCE, seed=1)
    later = solved(arm, missed, again.q) & again.success
    return [
        {"pose": int(i), "position": float(p), "rotation": float(r), "with_more_restarts": bool(later_one)}
        for i, p, r, later_one in zip(numbers, *errors(arm, missed, q[numbers]), later, strict=True)
    ]


def _near(arm: Arm, poses: Poses) -> Array:
    off = np.random.default_rng(1).uniform(-_NEARBY, _NEARBY, poses.q.shape)
    return np.clip(poses.q + off, *arm.limits)


def _calls(arm: Arm, poses: Poses, starts: Array | None) -> list[Callable[[], Any]]:
    def call(i: int) -> Callable[[], Any]:
        one = Poses(poses.q[i], poses.position[i], poses.quaternion[i])
        start = None if starts is None else starts[i]
        return lambda: _all_at_once(arm, one, start=start)

    return [call(i) for i in range(len(poses.q))]


def _core_calls(arm: Arm, poses: Poses, starts: Array) -> list[Callable[[], Any]]:
    def call(i: int) -> Callable[[], Any]:
        goal = poses.position[i], poses.quaternion[i], None, None, None, None, 1.0, 1.0, "", None, starts[i]
        return lambda: _core.inverse(arm.model, arm.frame, *goal, 100, 0, True, TOLERANCE, TOLERANCE)

    return [call(i) for i in range(len(poses.q))]


def _median(calls: list[Callable[[], Any]]) -> float:
    """[s] on the clock of one call: the median, which others on the machine hardly move."""
    spent = []
    for call in calls:
        begin = time.perf_counter()
        call()
        spent.append(time.perf_counter() - begin)
    return float(np.median(spent))
