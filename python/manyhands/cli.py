"""The command `manyhands`."""

import argparse
import json
import os
import shlex
import shutil
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from manyhands import video
from manyhands._core.envs import env_ids, make_env_batch
from manyhands._core.learn import CheckpointError
from manyhands.arguments import whole_number
from manyhands.extras import install_extra
from manyhands.interrupts import INTERRUPTED
from manyhands.viewer import command

if TYPE_CHECKING:
    from manyhands.training.run import Outcome
    from manyhands.training.run_folder import RunFolder

_TRAIN_EXAMPLES = """\
examples:
  manyhands train PandaReach                          learn to reach, in seconds
  manyhands train PandaReachJoints --seed 3           drive the joints; another seed
  manyhands train PandaReach --set gamma=0.9 --set hidden_layers=[128,128]
  manyhands train --resume runs/PandaReach-v3-...     go on where Ctrl-C stopped a run

A run folder holds config.json, metrics.csv, TensorBoard events, learning_curve.png, checkpoint.bin, policy.onnx and
evaluation.json. Ctrl-C saves a checkpoint and says how to go on.
"""
_EVALUATE_EXAMPLES = """\
examples:
  manyhands evaluate runs/PandaReach-v3-20261121-101500-0
  manyhands evaluate policy.onnx --env PandaReachDense --episodes 10000 --seed 7
"""
_EXAMPLES = """\
start here:
  manyhands envs                  what there is to learn
  manyhands train PandaReach      learn it
  manyhands evaluate runs/...     measure what was learned
  manyhands view PandaPush        see it in the browser, and drive it
  manyhands view PandaReach --policy runs/...    see what was learned
"""
_MOST_THREADS = 1024
_UNHEARD = 141  # the shell's code for a broken pipe


def _parser() -> argparse.ArgumentParser:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        "manyhands", description="Robot manipulation: learn tasks and measure policies.", epilog=_EXAMPLES,
        formatter_class=raw,
    )  # fmt: skip
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    train = commands.add_parser(
        "train", help="learn a task from nothing", description="Learns a task from nothing, or resumes a run.",
        epilog=_TRAIN_EXAMPLES, formatter_class=raw,
    )  # fmt: skip
    train.add_argument("task", nargs="?", help="environment, with or without its version: PandaReach, PandaReach-v3")
    train.add_argument("--resume", type=Path, metavar="RUN_DIR", help="go on with this run instead of a new one")
    train.add_argument("--seed", type=int, help="of networks, exploration and episodes (default 0)")
    train.add_argument("--num-envs", type=int, metavar="N", help="worlds stepped at a time (default 64)")
    train.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    train.add_argument(
        "--max-steps", type=int, metavar="N", help="environment steps at most, over all worlds (default 1000000)"
    )
    train.add_argument("--episodes", type=int, metavar="N", help="of the evaluation after training (default 1000)")
    train.add_argument("--runs", type=Path, default=Path("runs"), metavar="DIR", help="where run folders go (runs)")
    train.add_argument(
        "--set", action="append", metavar="NAME=VALUE", help="a setting of the trainer; may be given more than once"
    )
    train.add_argument(
        "--require-success", type=float, metavar="RATE", help="exit with 1 if the evaluation's success rate is below"
    )

    evaluate = commands.add_parser(
        "evaluate", help="measure a policy on fresh episodes",
        description="Measures the success of a policy on fresh episodes, with onnxruntime.",
        epilog=_EVALUATE_EXAMPLES, formatter_class=raw,
    )  # fmt: skip
    evaluate.add_argument("policy", type=Path, metavar="RUN_DIR|POLICY.onnx")
    evaluate.add_argument("--env", metavar="ID", help="default: the environment the policy was learned in")
    evaluate.add_argument("--episodes", type=int, default=1000, metavar="N")
    evaluate.add_argument("--seed", type=int, default=2 * 10**9, help="of the first episode; the others count up")
    evaluate.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    evaluate.add_argument("--json", action="store_true", help="print JSON")

    commands.add_parser("envs", help="list the environments")

    show = commands.add_parser(
        "view", help="show a robot, a scene or an environment in the browser",
        description="Shows a robot, a scene or an environment on a page in the browser, to play with.",
        epilog=command.EXAMPLES, formatter_class=raw,
    )  # fmt: skip
    command.add_arguments(show)

    film = commands.add_parser(
        "record", help="a video of episodes", description="Writes a video of a scripted expert, or of a policy.",
        epilog=video.EXAMPLES, formatter_class=raw,
    )  # fmt: skip
    video.add_arguments(film)
    return parser


def _program(name: str) -> str:
    """How the user's shell calls a script of this installation: by name if that finds it, else by path as called."""
    called = Path(sys.argv[0] if Path(sys.argv[0]).name == "manyhands" else sys.executable)
    script = called.with_name(name)
    found = shutil.which(name)
    if not script.exists() or (found is not None and script.samefile(found)):
        return name
    return shlex.quote(str(script) if script.parent.name else f"./{script}")


def _train(arguments: argparse.Namespace) -> int:
    from rich.console import Console

    from manyhands.training.run import TrainingRun
    from manyhands.training.run_folder import RunFolder
    from manyhands.training.settings import TrainSettings, parse_overrides, resolve_env_id

    changes = {
        "num_threads": arguments.threads,
        "max_env_steps": arguments.max_steps,
        "evaluation_episodes": arguments.episodes,
    }
    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, _MOST_THREADS)
    console = Console()
    if arguments.resume is not None:
        fixed = ("task", "seed", "num_envs", "set")
        if given := [name for name in fixed if getattr(arguments, name) is not None]:
            raise ValueError(f"a resumed run keeps its {', '.join(given)}: leave it out, or start a new run")
        folder = RunFolder(arguments.resume)
        settings = folder.read_settings(**changes)
        run = TrainingRun(folder, settings, resume=True)
        done = run.metrics.env_steps
        if run.metrics.solved:
            text = f"Solved already, after {done:,} steps; only evaluated again: {folder.path}"
        elif done < settings.max_env_steps:
            text = f"Resuming at {done:,} steps: {folder.path}"
        elif arguments.max_steps is not None:
            raise ValueError(
                f"{folder.path} has done {done} steps already: --max-steps {arguments.max_steps} adds none"
            )
        else:
            text = f"All {done:,} steps are done, --max-steps would add more; only evaluated again: {folder.path}"
        folder.write_config(settings)
        console.print(text, highlight=False, markup=False, soft_wrap=True)
    else:
        if arguments.task is None:
            raise ValueError("name a task, for example: manyhands train PandaReach (manyhands envs lists them)")
        changes |= {
            "seed": arguments.seed,
            "num_envs": arguments.num_envs,
            "overrides": parse_overrides(arguments.set or []),
        }
        given = {name: value for name, value in changes.items() if value is not None}
        settings = TrainSettings(resolve_env_id(arguments.task), **given)
        settings.trainer_config()
        folder = RunFolder.create(arguments.runs, settings)
        run = TrainingRun(folder, settings)
        console.print(
            f"Training {settings.env_id}, seed {settings.seed}: {folder.path}", highlight=False, soft_wrap=True
        )
    outcome = run.train(console)
    _summarise(outcome, folder, settings.seed, console.print)
    if outcome.evaluation is None:
        return INTERRUPTED
    required = arguments.require_success
    if required is not None and outcome.evaluation.success_rate < required:
        print(f"manyhands: success {outcome.evaluation.success_rate:.1%} is below {required:.1%}", file=sys.stderr)
        return 1
    return 0


def _summarise(outcome: "Outcome", folder: "RunFolder", seed: int, say: Callable[..., None]) -> None:
    lines = [""]
    program, path = _program("manyhands"), shlex.quote(str(folder.path))
    if outcome.evaluation is None:
        lines += [
            f"Stopped after {outcome.env_steps:,} steps and {outcome.training_seconds:.1f} s. Nothing is lost:",
            f"  {program} train --resume {path}",
        ]
    else:
        result = outcome.evaluation
        verdict = "Solved" if outcome.solved else "Not solved within the step limit"
        lines += [
            f"{verdict}: success {result.success_rate:.1%} on {result.episodes} fresh episodes "
            f"(return {result.mean_return:.2f}, length {result.mean_length:.1f})",
            f"Training took {outcome.training_seconds:.1f} s for {outcome.env_steps:,} steps, "
            f"the evaluation after it {outcome.evaluation_seconds:.1f} s.",
            "",
            f"In {folder.path}:",
            f"  {folder.curve.name:<20} how it went, as a picture",
            f"  {folder.metrics.name:<20} and as numbers (also as TensorBoard events)",
            f"  {folder.policy.name:<20} the policy, for onnxruntime",
            f"  {folder.evaluation.name:<20} success, return and length",
            f"  {folder.checkpoint.name:<20} to go on from",
            "",
            "Next:",
            f"  {program} evaluate {path}",
            f"  {program} view {result.env_id} --policy {path}",
            f"  {program} train {result.env_id} --seed {seed + 1}",
            f"  {_program('tensorboard')} --logdir {shlex.quote(str(folder.path.parent))}",
        ]
        if not outcome.solved:
            lines.append(f"  {program} train --resume {path} --max-steps {2 * outcome.env_steps}")
    say("\n".join(lines), highlight=False, markup=False, soft_wrap=True)


def _evaluate(arguments: argparse.Namespace) -> int:
    from manyhands.training.evaluation import PolicyFile, evaluate
    from manyhands.training.settings import resolve_env_id

    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, _MOST_THREADS)
    policy = PolicyFile(arguments.policy)
    name = arguments.env or policy.env_id
    if name is None:
        raise ValueError(f"{arguments.policy} does not say which environment it was learned in: name one with --env")
    result = evaluate(policy, resolve_env_id(name), arguments.episodes, arguments.seed, arguments.threads)
    if arguments.json:
        print(json.dumps(asdict(result), indent=2))
    else:
        print(
            f"{result.env_id}: success {result.success_rate:.1%} on {result.episodes} episodes from seed "
            f"{result.first_seed} (return {result.mean_return:.2f}, length {result.mean_length:.1f})"
        )
    return 0


def _envs() -> int:
    for name in env_ids():
        spec = make_env_batch(name, 1).spec
        print(
            f"{name:<26} {spec.action_dim} actions, {spec.observation_dim} observations, goals of {spec.goal_dim}, "
            f"{spec.max_episode_steps} steps of {spec.dt:g} s"
        )
    return 0


def _run(arguments: argparse.Namespace) -> int:
    if arguments.command == "train":
        return _train(arguments)
    if arguments.command == "evaluate":
        return _evaluate(arguments)
    if arguments.command == "view":
        return command.run(arguments)
    if arguments.command == "record":
        return video.run(arguments)
    return _envs()


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 2 for a request that makes no sense, 130 after Ctrl-C."""
    parser = _parser()
    arguments = parser.parse_args(argv)
    try:
        code = _run(arguments)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # `manyhands envs | head` has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing is left to be said at exit
        return _UNHEARD
    except (ValueError, OSError, CheckpointError) as error:
        print(f"manyhands {arguments.command}: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        extras = {"view": "viewer", "record": "video"}
        extra = "train" if error.name == "onnxruntime" else extras.get(arguments.command, "train")
        print(f"manyhands {arguments.command} needs {error.name}: {install_extra(extra)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
