"""What the tests of clients with a window share."""

import os
import subprocess
import sys
from functools import partial
from typing import Any

import viewed

import manyhands as mh
import manyhands.pybullet as p
from manyhands._core import pybullet_gui
from manyhands.pybullet import gui as windows

PANDA = str(mh.asset_path("panda/panda.urdf"))

until = partial(viewed.until, seconds=30.0)


def page_of(client: int) -> Any:
    return windows.page(client)


def box(client: int, at: tuple[float, float, float] = (0, 0, 1), mass: float = 1) -> int:
    shape = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.1] * 3, physicsClientId=client)
    return p.createMultiBody(mass, shape, -1, at, physicsClientId=client)


def link_of(client: int, body: int) -> str:
    """The name of a body's base in frames."""
    model = pybullet_gui.frame(client).model
    assert model is not None
    return next(link.name for link in model.links if link.name.startswith(f"b{body}/"))


def position(client: int, body: int) -> tuple[float, float, float]:
    return p.getBasePositionAndOrientation(body, physicsClientId=client)[0]


def run_program(code: str, page: str) -> subprocess.CompletedProcess[str]:
    """A program of its own, on a machine without a screen."""
    environment = {**os.environ, windows.SWITCH: page, "DISPLAY": "", "WAYLAND_DISPLAY": ""}
    return subprocess.run(
        [sys.executable, "-c", f"import manyhands.pybullet as p\n{code}"],
        env=environment, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
