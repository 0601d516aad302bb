"""The command `manyhands clone`: a policy from a dataset."""

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.env_names import VERSION, resolve_env_id
from manyhands.files import replacing

if TYPE_CHECKING:
    from manyhands._core.envs import EnvSpec
    from manyhands.demos.episodes import Demonstrations
    from manyhands.training.cloning import ClonedPolicy, CloningSettings

EXAMPLES = """\
examples:
  manyhands clone datasets/PandaPush/expert-v0               the network says the next action
  manyhands clone datasets/PandaPush/expert-v0 --chunk 10    the next ten, of which the first is done
  manyhands clone PandaPush-lerobot --out push.onnx --steps 50000
  manyhands view PandaPush --policy PandaPush-clone.onnx     see what was learned

It reads what manyhands demos writes, and datasets of Minari's and LeRobot's that hold the same (--env says of which
environment).
"""
_THREADS = 2  # as many as gradient steps can use
_FIRST_SEED = 2 * 10**9  # of the evaluation, as of `manyhands evaluate`


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands clone`."""
    parser.add_argument("dataset", type=Path, metavar="DATASET", help="a folder of Minari's or LeRobot's, or FILE.npz")
    parser.add_argument("--chunk", type=int, default=1, metavar="K", help="actions predicted at a time (1)")
    parser.add_argument("--env", metavar="ID", help="default: the environment that the dataset names")
    parser.add_argument("-o", "--out", type=Path, metavar="FILE.onnx", help="default: ENV-clone.onnx")
    parser.add_argument("--steps", type=int, default=20_000, metavar="N", help="gradient steps (20000)")
    parser.add_argument("--hidden", type=int, nargs="+", default=[256, 256], metavar="UNITS", help="layers (256 256)")
    parser.add_argument("--batch-size", type=int, default=256, metavar="N", help="steps of a gradient step, even (256)")
    parser.add_argument("--learning-rate", type=float, default=1e-3, metavar="RATE", help="Adam's step size (0.001)")
    parser.add_argument("--seed", type=int, default=0, help="of the network and of what is drawn")
    parser.add_argument("--episodes", type=int, default=1000, metavar="N", help="of the evaluation; 0: none")
    parser.add_argument("--threads", type=int, metavar="N", help="1 or 2 to learn; all of them to evaluate")


def run(arguments: argparse.Namespace) -> int:
    """Learns, writes the policy and measures it."""
    from manyhands._core.envs import make_env_batch
    from manyhands.demos.formats import read
    from manyhands.training.cloning import CloningSettings
    from manyhands.training.evaluation import PolicyFile, evaluate
    from manyhands.training.policy_file import save_policy

    settings = CloningSettings(
        chunk=whole_number("--chunk", arguments.chunk, 1, 1000),
        steps=whole_number("--steps", arguments.steps, 1, 10**9),
        hidden_layers=[whole_number("--hidden", units, 1, 8192) for units in arguments.hidden],
        batch_size=whole_number("--batch-size", arguments.batch_size, 2, 2**20),
        learning_rate=arguments.learning_rate,
        seed=whole_number("--seed", arguments.seed, 0, 2**63),
    )
    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, MOST_THREADS)
    whole_number("--episodes", arguments.episodes, 0)
    shown = read(arguments.dataset)
    name = arguments.env or shown.env_id
    if name is None:
        raise ValueError(f"{arguments.dataset} does not say of which environment it is: name one with --env")
    env_id = resolve_env_id(name)
    spec = make_env_batch(env_id, 1).spec
    out = arguments.out or Path(f"{env_id.removesuffix(VERSION)}-clone.onnx")

    begin = time.perf_counter()
    shown.checked(arguments.dataset, spec)
    with replacing(out) as file:  # which says now if it cannot be written
        save_policy(_learn(shown, spec, settings, arguments.threads or _THREADS), env_id, file)
    seconds = time.perf_counter() - begin
    steps, episodes = len(shown.action), len(shown.lengths)
    print(f"manyhands: {out} has learned from {episodes:,} episodes ({steps:,} steps) in {seconds:.1f} s")
    if arguments.episodes:
        result = evaluate(PolicyFile(out), env_id, arguments.episodes, _FIRST_SEED, arguments.threads)
        print(
            f"  success {result.success_rate:.1%} on {result.episodes} fresh episodes "
            f"(return {result.mean_return:.2f}, length {result.mean_length:.1f})"
        )
    print(f"  watch it:  manyhands view {env_id} --policy {out}")
    return 0


def _learn(shown: "Demonstrations", spec: "EnvSpec", settings: "CloningSettings", threads: int) -> "ClonedPolicy":
    """With a bar on a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    from manyhands.training.cloning import clone

    console = Console(stderr=True)
    columns = (TextColumn("[bold]{task.description}"), BarColumn(), TextColumn("loss {task.fields[loss]:.4f}"))
    with Progress(
        *columns, TimeRemainingColumn(), console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(f"Cloning {spec.id}", total=settings.steps, loss=float("nan"))
        return clone(shown, spec, settings, threads, lambda step, loss: bar.update(task, completed=step, loss=loss))
