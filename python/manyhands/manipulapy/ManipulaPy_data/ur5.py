"""An arm of six axes, of the UR5e's kind."""

from manyhands.manipulapy.ManipulaPy_data import get_ur5_urdf

urdf_file = get_ur5_urdf()
