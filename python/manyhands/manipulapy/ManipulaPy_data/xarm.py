"""An arm of six axes, of the xArm6's kind."""

from manyhands.manipulapy.ManipulaPy_data import get_xarm_urdf

urdf_file = get_xarm_urdf()
