"""Inverse kinematics within a time, by the name of another module."""

from manyhands.manipulapy.kinematics import TracIKSolver, trac_ik_solve

__all__ = ["TracIKSolver", "trac_ik_solve"]
