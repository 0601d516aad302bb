"""manyhands.pybullet beside the real module: calls, files of its data folder, its examples and environments."""
