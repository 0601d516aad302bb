"""The command `manyhands view`."""

import argparse
import difflib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from manyhands import robots
from manyhands._core import World, asset_path
from manyhands._core.envs import env_ids
from manyhands.cli.named_env import POLICY, NamedEnv, given_options
from manyhands.cli.named_env import add_arguments as add_env_arguments
from manyhands.env_names import resolve_env_id
from manyhands.viewer import view

if TYPE_CHECKING:
    from manyhands.viewer import Viewer

EXAMPLES = """\
examples:
  manyhands view panda                        a robot that ships with the package
  manyhands view six_axis+two_finger          an arm of manyhands.robots, with a gripper on
  manyhands view my_robot.urdf
  manyhands view scene.xml
  manyhands view PandaPickAndPlace            an environment: drive it, or watch the scripted expert
  manyhands view PandaReach --policy runs/PandaReach-v3-...    what was learned acts
  manyhands view PandaPush --policy trained   the policy that ships acts
  manyhands view PandaPush --robot arm6 --control ee_pose --option object_shape=cylinder
  manyhands view PandaPush --host 0.0.0.0     for other machines; the address holds a token

The page has all controls. Ctrl-C ends it.
"""
_SCENES = (".urdf", ".xml", ".mjcf", ".sdf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands view`."""
    parser.add_argument(
        "target",
        metavar="ROBOT.urdf|SCENE.xml|ENV|ROBOT",
        help="a file, an environment, `panda`, `arm6`, or one of manyhands.robots",
    )
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on (this machine alone)")
    parser.add_argument("--port", type=int, default=8080, help="the first to try (8080)")
    parser.add_argument("--token", help="asked for in the page's address; default: none here, a random one elsewhere")
    parser.add_argument("--seed", type=int, help="of an environment's first episode")
    parser.add_argument("--policy", metavar=POLICY, help="acts in the environment; trained: the one that ships")
    parser.add_argument(
        "--open", action=argparse.BooleanOptionalAction, help="in this machine's browser (where there is a screen)"
    )
    parser.add_argument(
        "--play", action=argparse.BooleanOptionalAction, help="begin at once (environments begin, robots wait)"
    )
    add_env_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Shows the target until Ctrl-C."""
    with shown(arguments) as viewer:
        viewer.wait()
    return 0


def shown(arguments: argparse.Namespace) -> "Viewer":
    """The page of parsed arguments."""
    page: dict[str, Any] = {
        "host": arguments.host, "port": arguments.port, "token": arguments.token, "open_browser": arguments.open
    }  # fmt: skip
    world, options = _world(arguments.target), given_options(arguments)
    if world is None:
        viewer = _show_environment(arguments.target, options, arguments.policy, arguments.seed, page)
    elif options or arguments.policy is not None:
        given = "--policy" if arguments.policy is not None else f"the option {next(iter(options))}"
        raise ValueError(f"{given} is of environments, and {arguments.target} is none (manyhands envs lists them)")
    else:
        viewer = view(world, title=Path(arguments.target).name, **page)
        if viewer.source.joints is not None:
            _hold(viewer)
    if world is None if arguments.play is None else arguments.play:
        viewer.play()
    return viewer


def _world(target: str) -> World | None:
    """A world of the robot or scene that is meant; None if it is none. Raises ValueError on an unknown gripper."""
    name, gripper = robots.split(target)
    if name in (*robots.names(), *robots.OF_ENVIRONMENTS):
        return World(robots.load(name, gripper=gripper))
    path = _file(target)
    if path is None:
        return None
    world = World.from_file(path)
    if len(world.report):
        print(world.report)
    return world


def _file(target: str) -> Path | None:
    """The file that is meant; None if it is not a file. Raises ValueError on a file of another kind."""
    if Path(target).suffix.lower() in _SCENES:
        return Path(target)
    try:
        return asset_path(f"{target}/{target}.urdf")
    except (FileNotFoundError, RuntimeError):  # no such robot; no robots at all
        if Path(target).is_file():
            raise ValueError(f"{target} is no URDF, MJCF or SDF: expected a file {', '.join(_SCENES)}") from None
        return None


def _show_environment(
    target: str, options: dict[str, Any], policy: str | None, seed: int | None, page: dict[str, Any]
) -> "Viewer":
    named, actors = NamedEnv(_env_id(target), options), {}
    if policy is not None:
        learned = named.policy(policy)
        named = named.shown_to(learned)
        actors[Path(policy).resolve().name] = learned
    env = _environment(named)
    env.reset(seed=seed)
    viewer = view(env, title=named.title, **page)
    for name, act in actors.items():
        viewer.actor(name, act)
    return viewer


def _env_id(target: str) -> str:
    """The environment that is meant. Raises ValueError if there is none, with the nearest names, of robots too."""
    try:
        return resolve_env_id(target)
    except ValueError:
        known = [*robots.names(), *robots.OF_ENVIRONMENTS]
        near = difflib.get_close_matches(robots.split(target)[0], [*known, *env_ids()])
        if not set(near) & set(known):
            raise
    raise ValueError(f"there is no robot or environment {target!r}; did you mean {', '.join(near)}?")


def _environment(named: NamedEnv) -> gymnasium.Env[Any, Any]:
    """In a world that may be pushed and pulled, if nothing is asked for that only environments stepped in C++ have."""
    from manyhands.panda_gym import registration

    variant = named.variant
    if variant.keys() == {"task", "reward_type", "control_type"} and variant["control_type"] in ("ee", "joints"):
        env = registration.make_env(**variant)
    else:
        env = named.make()
    env.spec = gymnasium.spec(named.id)
    return env


def _hold(viewer: "Viewer") -> None:
    """A robot stands where its joints may be, and its motors hold it there."""
    joints = viewer.source.joints
    assert joints is not None
    places = {knob.name: float(np.clip(joints.value(knob), knob.lower, knob.upper)) for knob in joints.knobs}
    viewer.player.do(lambda: joints.move(places, place=True), wait=2.0)
