"""The command `manyhands train`."""

import argparse
import shlex
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from manyhands.arguments import MOST_THREADS, rate, whole_number
from manyhands.env_names import resolve_env_id
from manyhands.interrupts import INTERRUPTED
from manyhands.training.console import counted

if TYPE_CHECKING:
    from manyhands._core.learn import TrainerConfig
    from manyhands.training.console import Console
    from manyhands.training.recipe import Recipe
    from manyhands.training.run import Outcome, TrainingRun
    from manyhands.training.run_folder import RunFolder
    from manyhands.training.settings import TrainSettings

    _Begin = Callable[[TrainSettings], AbstractContextManager[tuple[TrainingRun, RunFolder, str]]]

_MOST_WORKERS = 4096
_MANY_WORLDS = 20_000  # take a while to make

EXAMPLES = """\
examples:
  manyhands train PandaReach                          learn to reach, in seconds
  manyhands train PandaPush                           learn to push, by the recipe that is shipped for it
  manyhands train PandaPush --recipe mine.yaml        by one of your own
  manyhands train PandaPush --recipe pixels           from pictures of two cameras
  manyhands train PandaReachJoints --seed 3           drive the joints; another seed
  manyhands train PandaPush --randomize               another robot and cube in every episode
  manyhands train PandaReach --set gamma=0.9 --set hidden_layers=[128,128]
  manyhands train --resume runs/PandaReach-v3-...     go on where Ctrl-C stopped a run
  manyhands train PandaPush --ray auto --workers 8    with worlds in eight processes of a Ray cluster

A run folder holds config.json, metrics.csv, TensorBoard events, learning_curve.png, checkpoint.bin, policy.onnx and
evaluation.json. Ctrl-C saves a checkpoint and says how to go on.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands train`."""
    parser.add_argument("task", nargs="?", help="environment, with or without its version: PandaReach, PandaReach-v3")
    parser.add_argument("--resume", type=Path, metavar="RUN_DIR", help="go on with this run instead of a new one")
    parser.add_argument("--seed", type=int, help="of networks, exploration and episodes (default 0)")
    parser.add_argument(
        "--recipe", type=Path, metavar="FILE|pixels",
        help="settings (default: those shipped for the task); pixels: those shipped for learning it from pictures",
    )  # fmt: skip
    parser.add_argument("--num-envs", type=int, metavar="N", help="worlds stepped at a time (default: the recipe's)")
    parser.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    parser.add_argument(
        "--max-steps", type=int, metavar="N", help="environment steps at most, over all worlds (default: the recipe's)"
    )
    parser.add_argument("--episodes", type=int, metavar="N", help="of the evaluation after training (default 1000)")
    parser.add_argument(
        "--ray",
        metavar="ADDRESS",
        help='worlds run on a Ray cluster: HOST:PORT, "auto", or "local" to start one',
    )
    parser.add_argument(
        "--workers", type=int, metavar="N", help="processes of the cluster (default: one for each core but one)"
    )
    parser.add_argument("--runs", type=Path, default=Path("runs"), metavar="DIR", help="where run folders go (runs)")
    parser.add_argument(
        "--randomize", action="store_true",
        help="every episode another robot and object, by the ranges of docs/randomization.md; critics see which",
    )  # fmt: skip
    parser.add_argument(
        "--set", action="append", metavar="NAME=VALUE", help="a setting of the trainer; may be given more than once"
    )
    parser.add_argument(
        "--require-success", type=float, metavar="RATE",
        help="exit with 1 if the evaluation's success is below, 0 to 1: 0.9 for 90 %%",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Learns, measures what was learned, and says where it is."""
    from manyhands.training.console import make_console

    _check_numbers(arguments)
    console = make_console()
    prepare = _prepare_new if arguments.resume is None else _prepare_resumed
    settings, begin = prepare(arguments)
    if arguments.ray is None:
        return _make_and_train(arguments, console, settings, begin)
    from manyhands.training.cluster import Cluster

    with Cluster(arguments.ray) as cluster:
        if arguments.resume is None and arguments.workers is None:
            settings = replace(settings, workers=min(cluster.default_workers(), settings.num_envs))
        return _make_and_train(arguments, console, settings, begin)


def _make_and_train(
    arguments: argparse.Namespace, console: "Console", settings: "TrainSettings", begin: "_Begin"
) -> int:
    from manyhands.training.memory import in_gigabytes, require_memory

    taken = require_memory(settings)
    if settings.num_envs > _MANY_WORLDS and settings.workers is None:
        text = f"Making {settings.num_envs:,} worlds, which takes about {in_gigabytes(taken)} of memory"
        console.print(text, highlight=False, markup=False, soft_wrap=True)
    with begin(settings) as begun:
        return _train(arguments, console, *begun)


def _check_numbers(arguments: argparse.Namespace) -> None:
    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, MOST_THREADS)
    if arguments.require_success is not None:
        rate("--require-success", arguments.require_success)
    if arguments.workers is not None:
        whole_number("--workers", arguments.workers, 1, _MOST_WORKERS)
        if arguments.ray is None:
            raise ValueError("--workers are those of a Ray cluster: name it with --ray (--ray local starts one here)")


def _prepare_new(arguments: argparse.Namespace) -> "tuple[TrainSettings, _Begin]":
    """Settings that make sense, and what begins the run."""
    from manyhands.training.announcement import announce
    from manyhands.training.lock import locked
    from manyhands.training.optional import left_out
    from manyhands.training.randomization import randomized
    from manyhands.training.run import TrainingRun
    from manyhands.training.run_folder import RunFolder
    from manyhands.training.settings import parse_overrides

    if arguments.task is None:
        raise ValueError("name a task, for example: manyhands train PandaReach (manyhands envs lists them)")
    changes = _changes(arguments) | {
        "seed": arguments.seed,
        "num_envs": arguments.num_envs,
        "workers": arguments.workers or (None if arguments.ray is None else 1),
        "overrides": parse_overrides(arguments.set or []),
    }
    recipe, settings = new_settings(arguments.task, arguments.recipe, changes)
    if arguments.randomize:
        settings = randomized(settings, changes["overrides"], arguments.max_steps)
    settings.trainer_config()

    @contextmanager
    def begin(settings: "TrainSettings") -> "Iterator[tuple[TrainingRun, RunFolder, str]]":
        run = TrainingRun(settings)
        folder = RunFolder.create(arguments.runs, settings, run.save)
        lines = [f"Training {settings.env_id}, seed {settings.seed}: {folder.path}", *announce(recipe, settings)]
        lines += left_out()
        with locked(folder.path):
            yield run, folder, "\n".join(lines)

    return settings, begin


def _prepare_resumed(arguments: argparse.Namespace) -> "tuple[TrainSettings, _Begin]":
    """The settings of a run that is there, and what resumes it."""
    from manyhands.training.lock import locked
    from manyhands.training.run import TrainingRun
    from manyhands.training.run_folder import RunFolder

    fixed = ("seed", "recipe", "num_envs", "workers", "set", "randomize")
    given = [f"--{name.replace('_', '-')}" for name in fixed if getattr(arguments, name) not in (None, False)]
    if given := [*([] if arguments.task is None else [arguments.task]), *given]:
        raise ValueError(f"a resumed run keeps its task and settings: leave out {', '.join(given)}, or start a new run")
    folder = RunFolder(arguments.resume)
    settings = folder.read_settings(**_changes(arguments))
    if (settings.workers is None) != (arguments.ray is None):
        wanted = "without --ray" if settings.workers is None else "with --ray"
        raise ValueError(f"{folder.path} was begun {wanted}, and can only go on so")

    @contextmanager
    def begin(settings: "TrainSettings") -> "Iterator[tuple[TrainingRun, RunFolder, str]]":
        with locked(folder.path):
            run = TrainingRun(settings, folder.checkpoint)
            done = run.metrics.env_steps
            if run.iterations_left > 0:
                folder.write_config(settings)
                text = f"Resuming at {done:,} steps: {folder.path}"
            elif run.metrics.solved:
                text = f"Solved already, after {done:,} steps; only evaluated again: {folder.path}"
            elif arguments.max_steps is not None:
                raise ValueError(
                    f"{folder.path} has done {done} steps already: --max-steps {arguments.max_steps} adds none"
                )
            else:
                text = f"All {done:,} steps are done, --max-steps would add more; only evaluated again: {folder.path}"
            yield run, folder, text

    return settings, begin


def _changes(arguments: argparse.Namespace) -> dict[str, Any]:
    """What may differ in a run that is resumed."""
    return {
        "num_threads": arguments.threads,
        "max_env_steps": arguments.max_steps,
        "evaluation_episodes": arguments.episodes,
    }


def _train(
    arguments: argparse.Namespace, console: "Console", run: "TrainingRun", folder: "RunFolder", introduction: str
) -> int:
    console.print(introduction, highlight=False, markup=False, soft_wrap=True)
    outcome = run.train(folder, console)
    _summarise(outcome, folder, run.settings, arguments.ray, console.print)
    if outcome.evaluation is None:
        return INTERRUPTED
    required = arguments.require_success
    if required is not None and outcome.evaluation.success_rate < required:
        print(f"manyhands: success {outcome.evaluation.success_rate:.1%} is below {required:.1%}", file=sys.stderr)
        return 1
    return 0


def new_settings(
    task: str, recipe_file: Path | None, changes: Mapping[str, Any]
) -> "tuple[Recipe | None, TrainSettings]":
    """The recipe of a new run, a user's own or the one shipped, and its settings with `changes` that are not None.

    Raises ValueError on an unknown task and a recipe for another one, OSError if the recipe cannot be read.
    """
    from manyhands.training.recipe import find_recipe, named_recipe
    from manyhands.training.settings import TrainSettings

    given = {name: value for name, value in changes.items() if value is not None}
    env_id = resolve_env_id(task)
    recipe = find_recipe(env_id) if recipe_file is None else named_recipe(recipe_file, env_id)
    return recipe, TrainSettings(env_id, **given) if recipe is None else recipe.settings(**given)


def _summarise(
    outcome: "Outcome", folder: "RunFolder", settings: "TrainSettings", ray: str | None, say: Callable[..., None]
) -> None:
    lines = [""]
    with_ray = "" if ray is None else f" --ray {shlex.quote(ray)}"
    program, path = _program("manyhands"), shlex.quote(str(folder.path))
    if outcome.evaluation is None:
        lines += [
            f"Stopped after {outcome.env_steps:,} steps and {outcome.training_seconds:.1f} s. Nothing is lost:",
            f"  {program} train --resume {path}{with_ray}",
        ]
    else:
        result = outcome.evaluation
        lines += [
            f"{'Solved' if outcome.solved else 'At the step limit'}: success {result.success_rate:.1%} on "
            f"{counted(result.episodes, 'fresh episode')} "
            f"(return {result.mean_return:.2f}, length {result.mean_length:.1f})",
            *([] if outcome.solved else [_not_solved(settings.trainer_config())]),
            f"Training took {outcome.training_seconds:.1f} s for {outcome.env_steps:,} steps, "
            f"the evaluation after it {outcome.evaluation_seconds:.1f} s.",
            *([f"It waited {outcome.waited_seconds:.1f} s for its workers."] if outcome.waited_seconds else []),
            "",
            f"In {folder.path}:",
            *(f"  {file.name:<20} {what}" for file, what in _files(folder).items() if file.exists()),
            "",
            "Next:",
        ]
        if folder.policy.exists():
            lines += [f"  {program} evaluate {path}", f"  {program} view {result.env_id} --policy {path}"]
        lines.append(f"  {program} train {result.env_id} --seed {settings.seed + 1}{with_ray}")
        if any(folder.path.glob("events.*")):
            lines.append(f"  {_program('tensorboard')} --logdir {shlex.quote(str(folder.path.parent))}")
        if not outcome.solved:
            lines.append(f"  {program} train --resume {path}{with_ray} --max-steps {2 * outcome.env_steps}")
    say("\n".join(lines), highlight=False, markup=False, soft_wrap=True)


def _not_solved(config: "TrainerConfig") -> str:
    """What the run would have stopped for before its limit."""
    if config.stop_streak == 0:
        return "It was to train up to the limit (stop_streak is 0)."
    return (
        f"Solved would be {counted(config.stop_streak, 'evaluation')} of "
        f"{config.evaluation_episodes} episodes in a row with at least {config.stop_success_rate:.1%}."
    )


def _files(folder: "RunFolder") -> dict[Path, str]:
    """What each file of a run is."""
    return {
        folder.curve: "how it went, as a picture",
        folder.metrics: "how it went, as numbers",
        folder.policy: "the policy, for onnxruntime",
        folder.evaluation: "success, return and length",
        folder.checkpoint: "to go on from",
        folder.randomization: "success over each range",
    }


def _program(name: str) -> str:
    """How the user's shell calls a script of this installation: by name if that finds it, else by path as called."""
    called = Path(sys.argv[0] if Path(sys.argv[0]).name == "manyhands" else sys.executable)
    script = called.with_name(name)
    found = shutil.which(name)
    if not script.exists() or (found is not None and script.samefile(found)):
        return name
    return shlex.quote(str(script) if script.parent.name else f"./{script}")
