"""All cases, in the order of the table."""

from benchmarks.accuracy import (
    free_fall,
    friction,
    grasp,
    impulse,
    jam,
    loops,
    motor,
    piles,
    pinch,
    rolling,
    spin,
    stacking,
)
from benchmarks.accuracy.case import Case

_FAMILIES = (rolling, piles, free_fall, pinch, grasp, friction, jam, stacking, loops, spin, motor, impulse)
CASES: dict[str, Case] = {case.name: case for family in _FAMILIES for case in family.CASES}
