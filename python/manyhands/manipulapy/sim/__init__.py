"""A manipulator in a world: trajectories played, followed, and led by sliders."""

from manyhands.manipulapy.sim.simulation import CONNECT, RobotFileError, Simulation, newest_client, scenery

__all__ = ["CONNECT", "RobotFileError", "Simulation", "newest_client", "scenery"]
