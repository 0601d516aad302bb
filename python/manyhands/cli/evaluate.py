"""The command `manyhands evaluate`."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.env_names import resolve_env_id

EXAMPLES = """\
examples:
  manyhands evaluate runs/PandaReach-v3-20261121-101500-0
  manyhands evaluate policy.onnx --env PandaReachDense --episodes 10000 --seed 7
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What comes after `manyhands evaluate`."""
    parser.add_argument("policy", type=Path, metavar="RUN_DIR|POLICY.onnx")
    parser.add_argument("--env", metavar="ID", help="default: the environment the policy was learned in")
    parser.add_argument("--episodes", type=int, default=1000, metavar="N")
    parser.add_argument("--seed", type=int, default=2 * 10**9, help="of the first episode; the others count up")
    parser.add_argument("--threads", type=int, metavar="N", help="default: MANYHANDS_THREADS, or one for each core")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> int:
    """Measures a policy and prints how it did."""
    from manyhands.training.evaluation import PolicyFile, evaluate

    if arguments.threads is not None:
        whole_number("--threads", arguments.threads, 1, MOST_THREADS)
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
