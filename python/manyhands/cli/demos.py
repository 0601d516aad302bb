"""The command `manyhands demos`: episodes of an expert or a policy, as a dataset."""

import argparse
import copy
import math
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import gymnasium

from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.cli.named_env import POLICY, NamedEnv, given_options
from manyhands.cli.named_env import add_arguments as add_env_arguments
from manyhands.demos.collect import collect
from manyhands.demos.episodes import Episode, Source
from manyhands.demos.formats import FORMATS, write
from manyhands.env_names import VERSION, resolve_env_id
from manyhands.envs.vector import ArmVectorEnv
from manyhands.files import require_new
from manyhands.training.console import counted

EXAMPLES = """\
examples:
  manyhands demos PandaPush -n 1000                       the scripted expert, for minari.load_dataset
  manyhands demos PandaPush --format lerobot --cameras front wrist
  manyhands demos PandaPush --policy runs/PandaPush-v3-... --success-only
  manyhands demos PandaStack --noise 0.1                  how to come back from where it should not be
  manyhands clone datasets/PandaPush/expert-v0            learn from them

Episodes begin from --seed, --seed + 1 and so on, and are the same whenever they are made. With --noise, actions are
kept as they were done and as they were intended.
"""
_WORLDS, _SEEN_WORLDS = 256, 32  # stepped at a time: without pictures, and with


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands demos`."""
    parser.add_argument("env", metavar="ENV", help="environment, with or without its version")
    parser.add_argument("-n", "--episodes", type=int, default=100, metavar="N", help="default: 100")
    parser.add_argument("--seed", type=int, default=0, help="of the first episode; the others count up")
    parser.add_argument("--format", choices=FORMATS, help="default: npz if --out ends so, else minari")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="PATH",
        help="default: datasets/ENV/expert-v0 for Minari, ENV-lerobot or ENV.npz for the others",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="replace what is there")
    parser.add_argument("--policy", default="expert", metavar=f"expert|{POLICY}", help="default: expert")
    parser.add_argument("--success-only", action="store_true", help="leave failures out, and run more episodes instead")
    parser.add_argument("--noise", type=float, default=0.0, metavar="S", help="standard deviation added to actions")
    parser.add_argument("--cameras", nargs="+", default=[], metavar="NAME", help="pictures by: front, top, wrist")
    parser.add_argument("--size", type=int, nargs=2, default=(84, 84), metavar=("WIDTH", "HEIGHT"), help="[pixels]")
    parser.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    add_env_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Writes the dataset and says how to load it."""
    from rich.console import Console
    from rich.progress import track

    width, height = arguments.size
    options = given_options(arguments)
    if arguments.cameras:
        options["cameras"] = {name: {"width": width, "height": height} for name in arguments.cameras}
    named = NamedEnv(resolve_env_id(arguments.env), options)
    wanted = whole_number("--episodes", arguments.episodes, 1, 10**7)
    seed = whole_number("--seed", arguments.seed, 0, 2**63)
    if not (math.isfinite(arguments.noise) and arguments.noise >= 0):
        raise ValueError(f"--noise is {arguments.noise}, expected 0 or more")
    out = arguments.out or _default_path(named, arguments.format or "minari", arguments.policy)
    format = arguments.format or ("npz" if out.suffix == ".npz" else "minari")
    require_new(out, arguments.force)
    env = _vector_env(named, min(wanted, _SEEN_WORLDS if arguments.cameras else _WORLDS), arguments.threads)
    episodes = collect(
        env, _policy(arguments.policy, named), wanted, seed, arguments.noise, success_only=arguments.success_only
    )
    source = Source(
        named.id, _env_spec(named), named.spec(), Path(arguments.policy).name, arguments.noise, seed,
        dict.fromkeys(arguments.cameras, (height, width)),
    )  # fmt: skip
    console, tally, begin = Console(stderr=True), _Tally(), time.perf_counter()
    shown = track(
        episodes, f"Recording {named.id}", total=wanted, console=console, transient=True,
        disable=not console.is_terminal,
    )  # fmt: skip
    write(format, tally.count(shown), source, out, arguments.force)
    print(
        f"manyhands: {counted(tally.episodes, 'episode')} {'is' if tally.episodes == 1 else 'are'} in {out} "
        f"({tally.steps:,} steps, success {tally.successes / tally.episodes:.1%}, {time.perf_counter() - begin:.1f} s)"
    )
    print(f"  load them:        {_loading(format, out)}\n  learn from them:  manyhands clone {out}")
    return 0


class _Tally:
    def __init__(self) -> None:
        self.episodes = self.steps = self.successes = 0

    def count(self, episodes: Iterable[Episode]) -> Iterator[Episode]:
        """The episodes, which are counted as they pass."""
        for episode in episodes:
            self.episodes += 1
            self.steps += len(episode)
            self.successes += episode.succeeded
            yield episode


def _default_path(named: NamedEnv, format: str, policy: str) -> Path:
    name = named.id.removesuffix(VERSION)
    if format == "minari":
        return Path("datasets", name, "expert-v0" if policy == "expert" else "policy-v0")
    return Path(f"{name}-lerobot" if format == "lerobot" else f"{name}.npz")


def _vector_env(named: NamedEnv, worlds: int, threads: int | None) -> ArmVectorEnv:
    if threads is not None:
        whole_number("--threads", threads, 1, MOST_THREADS)
    named.make()  # says what is wrong with options
    return ArmVectorEnv(worlds, **named.variant, num_threads=threads)


def _policy(given: str, named: NamedEnv) -> Callable[[], Callable[[Any], Any]]:
    if given == "expert":
        named.expert()
        return named.expert
    policy = named.policy(given)
    return lambda: policy


def _env_spec(named: NamedEnv) -> str:
    """Gymnasium's, with the options."""
    spec = copy.deepcopy(gymnasium.spec(named.id))
    spec.kwargs |= named.variant
    return spec.to_json()


def _loading(format: str, path: Path) -> str:
    """How a program reads it, in Python."""
    if format == "minari":
        return f"minari.MinariDataset({str(path / 'data')!r})"
    if format == "lerobot":
        return f"LeRobotDataset('manyhands/{path.name}', root={str(path)!r})"
    return f"numpy.load({str(path)!r})"
