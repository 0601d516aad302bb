"""PyBullet's module over this engine: `import manyhands.pybullet as p` in place of `import pybullet as p`.

The functions have PyBullet's names, arguments, units, frames and tuples, and raise `error` where it does. They are
built in, so that `pybullet_utils.bullet_client.BulletClient` works. docs/coming_from_pybullet.md tells what differs.

`_diagnose(client)` says what commonly goes wrong, as `World.diagnose` does. For tests, `_set_parameter`, `_press_key`,
`_move_mouse` and `_click_mouse` do what people do on a client's page.
"""

from manyhands._core.pybullet import *  # noqa: F403
from manyhands._core.pybullet_gui import click_mouse as _click_mouse  # noqa: F401
from manyhands._core.pybullet_gui import diagnose as _diagnose  # noqa: F401
from manyhands._core.pybullet_gui import move_mouse as _move_mouse  # noqa: F401
from manyhands._core.pybullet_gui import press_key as _press_key  # noqa: F401
from manyhands._core.pybullet_gui import set_parameter as _set_parameter  # noqa: F401
from manyhands.pybullet.gui import listen as _listen

_listen()
