"""The command `manyhands evaluate`."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from manyhands._core.envs import env_ids, make_env_batch
from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.cli.named_env import POLICY, TRAINED, NamedEnv
from manyhands.env_names import resolve_env_id, versioned
from manyhands.envs import transfer_ranges
from manyhands.training.console import counted

if TYPE_CHECKING:
    from manyhands.policies import Policy
    from manyhands.training.evaluation import PolicyFile

EXAMPLES = """\
examples:
  manyhands evaluate runs/PandaReach-v3-20261121-101500-0
  manyhands evaluate policy.onnx --env PandaReachDense --episodes 10000 --seed 7
  manyhands evaluate PandaPush --policy trained       of the policy that ships, in C++ alone
  manyhands evaluate runs/PandaPush-v3-... --randomize     success over each range of robots and objects
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands evaluate`."""
    parser.add_argument("target", metavar="RUN_DIR|POLICY.onnx|ENV", help="a policy; or an environment, with --policy")
    parser.add_argument("--policy", metavar=POLICY, help="acts in the environment")
    parser.add_argument("--env", metavar="ID", help="default: the environment the policy was learned in")
    parser.add_argument("--episodes", type=int, default=1000, metavar="N")
    parser.add_argument("--seed", type=int, default=2 * 10**9, help="of the first episode; the others count up")
    parser.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    parser.add_argument(
        "--randomize", action="store_true",
        help="another robot and object in every episode: a table, and randomization.png in the run's folder",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> int:
    """Measures a policy and prints how it did."""
    from manyhands.training.evaluation import evaluate

    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, MOST_THREADS)
    env_id, policy = _named(arguments.target, arguments.policy, arguments.env)
    if arguments.randomize:
        return _over_ranges(arguments, env_id, policy)
    result = evaluate(policy, env_id, arguments.episodes, arguments.seed, arguments.threads)
    if arguments.json:
        print(json.dumps(asdict(result), indent=2))
    else:
        print(
            f"{result.env_id}: success {result.success_rate:.1%} on {counted(result.episodes, 'episode')} from seed "
            f"{result.first_seed} (return {result.mean_return:.2f}, length {result.mean_length:.1f})"
        )
    return 0


def _over_ranges(arguments: argparse.Namespace, env_id: str, policy: "PolicyFile | Policy") -> int:
    """Success where the robot and the objects differ: those of the run's own training, or those of transfer."""
    from manyhands.training.randomization import run_randomized, table
    from manyhands.training.randomization_picture import draw_randomization
    from manyhands.training.run_folder import RunFolder

    policy.require_fit(make_env_batch(env_id, 1).spec)
    given = Path(arguments.target)
    folder = RunFolder(given) if (given / "config.json").is_file() else None
    ranges = (folder.read_settings().randomize if folder is not None else {}) or transfer_ranges(env_id)
    run = run_randomized(policy, env_id, ranges, arguments.episodes, arguments.seed, arguments.threads)
    picture = Path("randomization.png") if folder is None else folder.randomization
    draw_randomization(picture, run, env_id)
    if arguments.json:
        print(json.dumps(run.to_dict(), indent=2))
    else:
        print(
            f"{env_id}: success {run.success.mean():.1%} on {counted(arguments.episodes, 'episode')} under these ranges"
        )
        print(table(run))
        print(f"Success over each range, as a picture: {picture}")
    return 0


def _named(target: str, given: str | None, env: str | None) -> "tuple[str, PolicyFile | Policy]":
    """The environment and the policy that a command names."""
    from manyhands.training.evaluation import PolicyFile

    if given is not None:
        if env is not None:
            raise ValueError(f"--env {env} names a second environment beside {target}: leave it out")
        named = NamedEnv(resolve_env_id(target))
        return named.id, named.policy(given)
    if not Path(target).exists() and versioned(target) in env_ids():
        raise ValueError(f"{target} is an environment: say what acts there, for example --policy {TRAINED}")
    policy = PolicyFile(Path(target))
    if env is None and policy.env_id is None:
        raise ValueError(f"{target} does not say which environment it was learned in: name one with --env")
    return resolve_env_id(env or policy.env_id or ""), policy
