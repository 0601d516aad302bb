"""Time-optimal motions beside TOPP-RA's own library, on the same paths."""

import numpy as np
import pytest

from manyhands import planning

ta = pytest.importorskip("toppra")
algorithm = pytest.importorskip("toppra.algorithm")
constraint = pytest.importorskip("toppra.constraint")

SPEED, ACCELERATION = np.linspace(0.8, 1.4, 7), np.linspace(2.0, 4.0, 7)


@pytest.mark.parametrize("seed", range(10))
def test_it_takes_as_long_as_toppra(seed: int) -> None:
    waypoints, knots = np.random.default_rng(seed).uniform(-1, 1, (6, 7)), np.arange(6.0)
    theirs, ours = ta.SplineInterpolator(knots, waypoints), planning.spline(knots, waypoints)
    s = np.linspace(0, 5, 100)
    np.testing.assert_allclose(theirs(s), ours.sample(s).q, atol=1e-9)
    limits = [
        constraint.JointVelocityConstraint(np.c_[-SPEED, SPEED]),
        constraint.JointAccelerationConstraint(
            np.c_[-ACCELERATION, ACCELERATION], discretization_scheme=constraint.DiscretizationType.Interpolation
        ),
    ]
    grid = np.linspace(0, 5, 1001)
    solver = algorithm.TOPPRA(limits, theirs, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    duration = solver.compute_trajectory().duration
    motion = planning.time_optimal(ours, velocity=SPEED, acceleration=ACCELERATION, intervals=1000)
    # TOPP-RA's crosses limits between grid points by 2e-5; ours gives way by as much.
    assert motion.duration == pytest.approx(duration, rel=3e-4)
