"""`path_planning` by another name."""

from manyhands.manipulapy.path_planning import (
    OptimizedTrajectoryPlanning,
    TrajectoryPlanning,
    create_optimized_planner,
)

__all__ = ["OptimizedTrajectoryPlanning", "TrajectoryPlanning", "create_optimized_planner"]
