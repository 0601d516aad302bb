"""What environments are written with."""

from gymnasium.utils import EzPickle, colorize

from manyhands.gym.utils import seeding

__all__ = ["EzPickle", "colorize", "seeding"]
