"""PyBullet's module over this engine: `import manyhands.pybullet as p` in place of `import pybullet as p`.

The functions have PyBullet's names, arguments, units, frames and tuples, and raise `error` where it does. They are
built in, so that `pybullet_utils.bullet_client.BulletClient` works. docs/coming_from_pybullet.md tells what differs.
"""

from manyhands._core.pybullet import *  # noqa: F403
