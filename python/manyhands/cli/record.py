"""The command `manyhands record`: a video of episodes."""

import argparse
import math
from collections.abc import Callable, Iterable, Iterator
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands.cli.named_env import POLICY, NamedEnv, given_options
from manyhands.cli.named_env import add_arguments as add_env_arguments
from manyhands.env_names import resolve_env_id
from manyhands.envs.single import ArmEnv
from manyhands.envs.spaces import RENDER_FPS
from manyhands.extras import needs
from manyhands.interrupts import INTERRUPTED, Interrupts
from manyhands.training.console import counted
from manyhands.training.run_folder import RunFolder
from manyhands.video import captioned, write_video

EXAMPLES = """\
examples:
  manyhands record PandaPickAndPlace                          three episodes of the scripted expert, as MP4
  manyhands record PandaPush --out push.gif --episodes 1 --speed 0.5
  manyhands record runs/PandaReach-v3-...                     of what was learned
  manyhands record PandaPush --policy trained                 of the policy that ships
  manyhands record PandaPush --robot arm6 --option render_yaw=90

Ctrl-C ends the video after the episode that is being filmed.
"""
_AFTER_SUCCESS = 8  # steps for which a reached goal is looked at
# Nearer than environments look by default: a cube is some 35 pixels wide. The floor is as light as that of the page.
_CAMERA = {"render_target_position": [-0.06, 0.0, 0.18], "render_distance": 1.0, "render_yaw": 55, "render_pitch": -24}
_FLOOR = {"render_floor": (0.66, 0.69, 0.72)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands record`."""
    parser.add_argument(
        "env", metavar="ENV|RUN_DIR", help="environment, with or without its version; or a run, of what it learned"
    )
    parser.add_argument("--policy", metavar=POLICY, help="default: the scripted expert")
    parser.add_argument("-o", "--out", type=Path, help="FILE.mp4 or FILE.gif; default: ENV.mp4")
    parser.add_argument("--episodes", type=int, default=3, metavar="N")
    parser.add_argument("--seed", type=int, default=0, help="of the first episode; the others count up")
    parser.add_argument("--size", type=int, nargs=2, default=(640, 480), metavar=("WIDTH", "HEIGHT"), help="[pixels]")
    parser.add_argument("--speed", type=float, default=1.0, metavar="X", help="0.5: half as fast as it is; default: 1")
    parser.add_argument(
        "--hold", type=float, default=1.0, metavar="SECONDS", help="for which an episode's end stands; default: 1"
    )
    parser.add_argument("--caption", metavar="TEXT", help="in the lower left corner; default: the environment's name")
    add_env_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Writes the video; with the first interrupt it ends after the episode that is being filmed."""
    from rich.console import Console
    from rich.progress import track

    env_id, policy = _named(arguments.env, arguments.policy)
    env = NamedEnv(env_id, given_options(arguments))
    out = arguments.out or Path(f"{env.id}.mp4")
    if arguments.episodes < 1:
        raise ValueError(f"--episodes is {arguments.episodes}; expected 1 or more")
    for name in ("speed", "hold"):
        value = getattr(arguments, name)
        if not (0 <= value < math.inf) or (name == "speed" and not 0.05 <= value <= 20):
            expected = "a number from 0.05 to 20" if name == "speed" else "0 or more seconds"
            raise ValueError(f"--{name} is {value}; expected {expected}")
    width, height = arguments.size
    env, act = _policy(policy, env)
    filmed = env.make(render_mode="rgb_array", render_width=width, render_height=height, **_CAMERA, **_FLOOR)
    caption = env.title if arguments.caption is None else arguments.caption
    fps = RENDER_FPS * arguments.speed
    wanted = arguments.episodes
    seeds = range(arguments.seed, arguments.seed + wanted)
    console = Console(stderr=True)
    begun: list[int] = []
    with Interrupts() as interrupts:
        shown = track(
            _until(interrupts, seeds, begun), f"Filming {env.title}", total=wanted, console=console, transient=True,
            disable=not console.is_terminal,
        )  # fmt: skip
        pictures = episodes(filmed, act, shown, env.max_steps, hold=round(arguments.hold * fps))
        with needs("video", "a video"):
            write_video(captioned(pictures, caption), out, fps)
    n = len(begun)
    is_whole = n == wanted
    count = counted(n, "episode") if is_whole else f"stopped; {n} of {wanted} episodes"
    print(f"manyhands: {count} of {env.title} {'is' if n == 1 else 'are'} in {out}")
    return 0 if is_whole else INTERRUPTED


def _until(interrupts: Interrupts, seeds: Iterable[int], begun: list[int]) -> Iterator[int]:
    """At least one seed, and no other after an interrupt; `begun` tells which."""
    for seed in seeds:
        begun.append(seed)
        yield seed
        if interrupts.requested:
            return


def episodes(
    env: ArmEnv, act: Callable[[], Callable[[Any], Any]], seeds: Iterable[int], max_steps: int, hold: int = 0
) -> Iterator[NDArray[np.uint8]]:
    """The pictures of episodes, each under a fresh policy, until shortly after success or max_steps; the last picture
    of each comes `hold` times more."""
    for seed in seeds:
        policy, left = act(), max_steps
        observation, _ = env.reset(seed=seed)
        yield (shown := _picture(env))
        while left > 0:
            observation, _, _, _, info = env.step(policy(observation))
            left = min(left - 1, _AFTER_SUCCESS) if info["is_success"] else left - 1
            yield (shown := _picture(env))
        yield from repeat(shown, hold)


def _picture(env: ArmEnv) -> NDArray[np.uint8]:
    picture = env.render()
    assert picture is not None
    return picture


def _named(target: str, policy: str | None) -> tuple[str, str | None]:
    """The id and the policy that a command names: an environment's, or of a run both."""
    if not (Path(target) / "config.json").is_file():
        return resolve_env_id(target), policy
    if policy is not None:
        raise ValueError(f"--policy {policy} names a second policy beside that of {target}: name the environment")
    return RunFolder(Path(target)).read_settings().env_id, target


def _policy(given: str | None, env: NamedEnv) -> tuple[NamedEnv, Callable[[], Callable[[Any], Any]]]:
    """The environment as a policy sees it, and what acts in an episode."""
    if given is None:
        env.spec()
        env.expert()
        return env, env.expert
    policy = env.policy(given)
    return env.shown_to(policy), lambda: policy
