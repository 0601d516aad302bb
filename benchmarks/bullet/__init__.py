"""manyhands.pybullet beside the real module: calls, and the files of its data folder."""
