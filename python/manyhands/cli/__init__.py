"""The command `manyhands`."""

import argparse
import os
import sys
from collections.abc import Sequence

from manyhands._core.envs import env_ids, make_env_batch
from manyhands._core.learn import CheckpointError, DivergenceError
from manyhands.cli import clone, compare, convert, demos, doctor, evaluate, record, sweep, train, view
from manyhands.extras import install_extra
from manyhands.interrupts import INTERRUPTED
from manyhands.isa import VERSION

_EXAMPLES = """\
start here:
  manyhands envs                  what there is to learn
  manyhands train PandaReach      learn it
  manyhands evaluate runs/...     measure what was learned
  manyhands sweep PandaPush       learn it from five seeds, and compare
  manyhands view PandaPush        see it in the browser, and drive it
  manyhands view PandaReach --policy runs/...    see what was learned
"""
_UNHEARD = 141  # the shell's code for a broken pipe
_COMMANDS = (
    ("train", train, "learn a task from nothing", "Learns a task from nothing, or resumes a run."),
    (
        "sweep", sweep, "train several seeds and settings at once",
        "Trains every seed with every combination of settings, in parallel, and compares what came out.",
    ),
    (
        "compare", compare, "learning curves of several runs",
        "Draws the learning curves of several runs with bands over seeds, and prints a table.",
    ),
    (
        "evaluate", evaluate, "measure a policy on fresh episodes",
        "Measures the success of a policy on fresh episodes, with onnxruntime.",
    ),
    (
        "view", view, "show a robot, a scene or an environment in the browser",
        "Shows a robot, a scene or an environment on a page in the browser, to play with.",
    ),
    (
        "convert", convert, "a robot or scene from URDF to MJCF, or back",
        "Reads a robot or scene and writes it in another format, to the last bit where that can say it.",
    ),
    ("record", record, "a video of episodes", "Writes a video of a scripted expert, or of a policy."),
    (
        "demos", demos, "a dataset of episodes", "Writes episodes of a scripted expert, or of a policy, as a dataset.",
    ),
    ("clone", clone, "learn a policy from a dataset", "Learns to do what the episodes of a dataset show."),
    (
        "doctor", doctor, "what is installed, and whether it works",
        "Says what is installed and what it runs on, and checks in a few seconds whether it works.",
    ),
)  # fmt: skip


def _parser() -> argparse.ArgumentParser:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        "manyhands", description="Robot manipulation: learn tasks and measure policies.", epilog=_EXAMPLES,
        formatter_class=raw,
    )  # fmt: skip
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, module, brief, description in _COMMANDS:
        command = commands.add_parser(
            name, help=brief, description=description, epilog=module.EXAMPLES, formatter_class=raw
        )
        module.add_arguments(command)
        command.set_defaults(run=module.run, parser=command)
    parser.add_argument("--version", action="version", version=f"manyhands {VERSION}")
    envs = commands.add_parser("envs", help="list the environments")
    envs.set_defaults(run=_envs, parser=envs)
    return parser


def _envs(_: argparse.Namespace) -> int:
    for name in env_ids():
        spec = make_env_batch(name, 1).spec
        print(
            f"{name:<26} {spec.action_dim} actions, {spec.observation_dim} observations, goals of {spec.goal_dim}, "
            f"{spec.max_episode_steps} steps of {spec.dt:g} s"
        )
    return 0


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 2 for a request that makes no sense, 130 after Ctrl-C."""
    parser = _parser()
    arguments, unknown = parser.parse_known_args(argv)
    if unknown:  # told with the usage of the command that was meant
        arguments.parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    try:
        code = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # `manyhands envs | head` has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing is left to be said at exit
        return _UNHEARD
    except (ValueError, OSError, CheckpointError, DivergenceError) as error:
        print(f"manyhands {arguments.command}: {error}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"manyhands {arguments.command}: there is not enough memory for so much of it", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        extras = {"view": "viewer", "record": "video", "demos": "demos", "clone": "demos"}
        extras |= {"onnx": "train", "onnxruntime": "train", "ray": "ray"}
        extra = extras.get(error.name or "") or extras.get(arguments.command, "train")
        print(f"manyhands {arguments.command} needs {error.name}: {install_extra(extra)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return INTERRUPTED
