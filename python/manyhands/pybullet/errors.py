"""PyBullet's exception, for our own modules: type stubs leave it out."""

from manyhands._core import pybullet

error: type[Exception] = pybullet.error  # pyright: ignore[reportAttributeAccessIssue]
