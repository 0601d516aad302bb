"""The command `manyhands view`."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from manyhands._core import World, asset_path
from manyhands.viewer import view

if TYPE_CHECKING:
    from manyhands.viewer import Viewer

EXAMPLES = """\
examples:
  manyhands view panda                        a robot that ships with the package
  manyhands view my_robot.urdf
  manyhands view scene.xml
  manyhands view PandaPickAndPlace            an environment: drive it, or watch the scripted expert
  manyhands view PandaPush --host 0.0.0.0     for other machines; the address holds a token

The page has all controls. Ctrl-C ends it.
"""
_SCENES = (".urdf", ".xml", ".mjcf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands view`."""
    parser.add_argument("target", metavar="ROBOT.urdf|SCENE.xml|ENV", help="a file, an environment, `panda` or `arm6`")
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on (this machine alone)")
    parser.add_argument("--port", type=int, default=8080, help="the first to try (8080)")
    parser.add_argument("--token", help="asked for in the page's address; default: none here, a random one elsewhere")
    parser.add_argument("--seed", type=int, help="of an environment's first episode")
    parser.add_argument("--open", action="store_true", help="open the page in this machine's browser")
    parser.add_argument("--play", action="store_true", help="begin at once")


def run(arguments: argparse.Namespace) -> int:
    """Shows the target until Ctrl-C."""
    target = arguments.target
    robot = _robot(target)
    shown = _environment(target, arguments.seed) if robot is None else _world(robot)
    with view(
        shown, host=arguments.host, port=arguments.port, token=arguments.token,
        title="" if robot is None else robot.name, open_browser=arguments.open,
    ) as viewer:  # fmt: skip
        if robot is not None and viewer.source.joints is not None:
            _hold(viewer)
        if arguments.play:
            viewer.play()
        viewer.wait()
    return 0


def _robot(target: str) -> Path | None:
    """The file that is meant; None if it is not a file."""
    if Path(target).suffix.lower() in _SCENES:
        return Path(target)
    try:
        return asset_path(f"{target}/{target}.urdf")
    except RuntimeError:
        return None


def _world(path: Path) -> World:
    world = World.from_file(path)
    if len(world.report):
        print(world.report)
    return world


def _environment(target: str, seed: int | None) -> gymnasium.Env[Any, Any]:
    from manyhands.panda_gym import registration
    from manyhands.training.settings import resolve_env_id

    name = resolve_env_id(target)
    variant = registration.VARIANTS[name.removesuffix("-v3")]
    env = registration.make_env(**variant)
    env.spec = gymnasium.spec(name)
    env.reset(seed=seed)
    return env


def _hold(viewer: "Viewer") -> None:
    """A robot stands where its joints may be, and its motors hold it there."""
    joints = viewer.source.joints
    assert joints is not None
    places = {knob.name: float(np.clip(joints.value(knob), knob.lower, knob.upper)) for knob in joints.knobs}
    viewer.player.do(lambda: joints.move(places, place=True), wait=2.0)
