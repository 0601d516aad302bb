"""PyBullet's own examples and environments, on PyBullet and on `manyhands.pybullet`."""
