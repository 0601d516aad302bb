"""The command `manyhands sweep`."""

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.cli import compare
from manyhands.cli.train import new_settings
from manyhands.env_names import resolve_env_id
from manyhands.interrupts import INTERRUPTED, Interrupts

if TYPE_CHECKING:
    from rich.console import Console

    from manyhands.training.settings import TrainSettings
    from manyhands.training.sweep import SweepRun

EXAMPLES = """\
examples:
  manyhands sweep PandaPush                           five seeds by the recipe that is shipped
  manyhands sweep PandaReach --seeds 3 --set gamma=0.9,0.95 --set batch_size=128,256    twelve runs
  manyhands sweep PandaReach --set 'hidden_layers=[64,64],[128,128]' --out sweeps/layers

Runs go to sweeps/ID, each in a folder with a name of its own. The same command goes on where it was stopped: runs that
are done are kept, others resumed. More seeds or values add runs to those that are there.
"""
_SECONDS_BETWEEN_LOOKS = 0.25


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands sweep`."""
    parser.add_argument("task", help="environment, with or without its version: PandaReach, PandaReach-v3")
    parser.add_argument("--seeds", type=int, default=5, metavar="N", help="runs of each setting, seeds 0 to N - 1 (5)")
    parser.add_argument(
        "--set", action="append", metavar="NAME=VALUE,...",
        help="values of a setting of the trainer; each combination is trained",
    )  # fmt: skip
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at a time, a thread each (default: the cores)")
    parser.add_argument("--recipe", type=Path, metavar="FILE", help="settings (default: those shipped for the task)")
    parser.add_argument("--num-envs", type=int, metavar="N", help="worlds stepped at a time (default: the recipe's)")
    parser.add_argument("--max-steps", type=int, metavar="N", help="environment steps at most (default: the recipe's)")
    parser.add_argument("--episodes", type=int, metavar="N", help="of the evaluation after training (default 1000)")
    parser.add_argument(
        "--randomize", action="store_true",
        help="every episode another robot and object, by the ranges of docs/randomization.md; critics see which",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", help="where the run folders go (sweeps/ID)")


def run(arguments: argparse.Namespace) -> int:
    """Trains all runs that are not done, and compares them."""
    from rich.console import Console

    from manyhands.training.comparison import read_groups
    from manyhands.training.lock import locked
    from manyhands.training.sweep import default_jobs, grid, prepare

    seeds = whole_number("--seeds", arguments.seeds, 1, 10_000)
    jobs = default_jobs() if arguments.jobs is None else whole_number("--jobs", arguments.jobs, 1, MOST_THREADS)
    choices = parse_choices(arguments.set or [])
    out = Path("sweeps") / resolve_env_id(arguments.task) if arguments.out is None else arguments.out
    at_once = min(jobs, seeds * len(grid(choices)))
    runs = prepare(out, lambda chosen: _settings(arguments, chosen, at_once), choices, seeds)
    console = Console()
    with locked(out):
        interrupted = _train(console, runs, jobs, out)
    done = [one.folder.path for one in runs if one.state == "done"]
    for one in runs:
        if one.state == "failed":
            text = f"{one.name} failed: {one.error} ({one.folder.log})"
            console.print(text, style="red", highlight=False, markup=False, soft_wrap=True)
    if interrupted:
        text = f"Stopped with {len(done)} of {len(runs)} runs done. The same command goes on from here."
        console.print(text, highlight=False, markup=False, soft_wrap=True)
        return INTERRUPTED
    if done:
        compare.show(console, read_groups(done)[0], "bootstrap", out / "comparison")
    return 0 if len(done) == len(runs) else 1


def _settings(arguments: argparse.Namespace, chosen: dict[str, Any], at_once: int) -> "TrainSettings":
    """Those of `manyhands train` with the same options, and the chosen values of trainer settings.

    Raises ValueError unless there is memory for so many runs at once.
    """
    from manyhands.training.memory import require_memory
    from manyhands.training.randomization import randomized

    changes = {
        "num_envs": arguments.num_envs,
        "max_env_steps": arguments.max_steps,
        "evaluation_episodes": arguments.episodes,
        "overrides": chosen,
    }
    _, settings = new_settings(arguments.task, arguments.recipe, changes)
    if arguments.randomize:
        settings = randomized(settings, chosen, arguments.max_steps)
    require_memory(settings, at_once)
    return settings


def parse_choices(assignments: Sequence[str]) -> dict[str, list[Any]]:
    """Values from texts such as "gamma=0.95,0.98" and "hidden_layers=[64,64],[128,128]". Raises ValueError."""
    from manyhands.training.settings import require_setting

    choices: dict[str, list[Any]] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise ValueError(f"{assignment!r} is no setting, expected NAME=VALUE,..., for example gamma=0.9,0.95")
        known = require_setting(name)
        if name in choices:
            raise ValueError(f"{name} is set twice: give its values as {name}=VALUE,VALUE")
        try:
            choices[name] = text.split(",") if isinstance(known, str) else json.loads(f"[{text}]")
        except json.JSONDecodeError as error:
            raise ValueError(f"{assignment!r}: {text!r} are no numbers, lists, true or false") from error
        if not choices[name]:
            raise ValueError(f"{assignment!r} has no value")
        if any(value in choices[name][:place] for place, value in enumerate(choices[name])):
            raise ValueError(f"{assignment!r} has a value twice")
    return choices


def _train(console: "Console", runs: "Sequence[SweepRun]", jobs: int, out: Path) -> bool:
    """Trains what is not done. Returns whether it was interrupted; then all that had begun has a checkpoint."""
    from manyhands.training.sweep import advance
    from manyhands.training.sweep_progress import SweepProgress

    kept = sum(run.state == "done" for run in runs)
    told = f", {kept} of them done already" if kept else ""
    console.print(
        f"Training {runs[0].settings.env_id}: {len(runs)} runs{told}, {jobs} at a time, in {out}",
        highlight=False, markup=False, soft_wrap=True,
    )  # fmt: skip
    try:
        with Interrupts() as interrupts, SweepProgress(console, runs) as progress:
            while advance(runs, jobs, interrupts):
                progress.update()
                time.sleep(_SECONDS_BETWEEN_LOOKS)
            progress.update()
            return interrupts.requested
    finally:
        for run in runs:
            run.kill()
