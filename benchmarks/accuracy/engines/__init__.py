"""The programs that run the cases, behind one interface."""

from benchmarks.accuracy.engines.base import CannotRunError, Contact, Settings, Simulation, build

__all__ = ["CannotRunError", "Contact", "Settings", "Simulation", "build"]
