"""Robot descriptions: read as trees of links and joints, changed, and several in one scene."""

from manyhands.manipulapy.urdf.modifier import URDFModifier, load_calibration, save_calibration
from manyhands.manipulapy.urdf.scene import RobotInstance, Scene
from manyhands.manipulapy.urdf.tree import URDF, Screws

__all__ = ["URDF", "RobotInstance", "Scene", "Screws", "URDFModifier", "load_calibration", "save_calibration"]
