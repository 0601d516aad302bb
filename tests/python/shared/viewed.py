"""What the tests of the viewer share: worlds to be shown, and waiting."""

import time

import manyhands as mh
from manyhands.viewer.joints import JointDrive

READY = [0.0, 0.41, 0.0, -1.85, 0.0, 2.26, 0.79, 0.02, 0.02]


def panda() -> mh.World:
    return mh.World.from_file(mh.asset_path("panda/panda.urdf"))


def ready(world: mh.World) -> JointDrive:
    """A Panda that its motors hold before the table."""
    drive = JointDrive(world)
    drive.move(dict(zip([knob.name for knob in drive.knobs], READY, strict=True)), place=True)
    return drive


def falling_ball() -> mh.World:
    world = mh.World()
    world.add_plane("floor")
    world.add_sphere("ball", 0.05, mass=0.2, position=[0, 0, 1.0])
    return world


def until(condition: object, seconds: float = 5.0) -> None:
    """Waits until a callable is true."""
    assert callable(condition)
    deadline = time.perf_counter() + seconds
    while not condition():
        assert time.perf_counter() < deadline, "it did not come about"
        time.sleep(0.01)
