"""Environments as a command line names them: an id, a robot, a control type, options."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from manyhands._core.envs import EnvSpec, control_types, max_episode_steps
from manyhands.env_names import variant_of
from manyhands.envs.parts import Obstacle
from manyhands.envs.single import ArmEnv
from manyhands.experts import Expert
from manyhands.policies import Policy, policy

if TYPE_CHECKING:
    from manyhands.training.evaluation import PolicyFile

POLICY = "trained|RUN_DIR|POLICY.onnx"  # what may be given as one
TRAINED = "trained"

_EXAMPLE = "for example --option object_shape=cylinder"


@dataclass(frozen=True)
class NamedEnv:
    """An environment, and what differs in it from what its id says."""

    id: str
    """With its version."""
    options: dict[str, Any] = field(default_factory=dict)
    """Keyword arguments of `ArmEnv`."""
    cameras: dict[str, Any] = field(default_factory=dict)
    """Those of a policy."""

    @property
    def variant(self) -> dict[str, Any]:
        """Task, types and options, as arguments of `ArmEnv`."""
        cameras = {"cameras": self.cameras} if self.cameras else {}
        return variant_of(self.id) | cameras | self.options

    def shown_to(self, policy: "Policy | PolicyFile") -> "NamedEnv":
        """The same with the cameras through which a policy sees."""
        return replace(self, cameras=policy.cameras)

    @property
    def title(self) -> str:
        """The id, and what differs."""
        differs = ", ".join(f"{name} {value}" for name, value in self.options.items())
        return f"{self.id} ({differs})" if differs else self.id

    @property
    def max_steps(self) -> int:
        """Of an episode."""
        return max_episode_steps(self.id)

    def make(self, **arguments: Any) -> ArmEnv:
        """The environment, with further arguments. Raises ValueError on an option that is not, or cannot be."""
        try:
            return ArmEnv(**{**arguments, **self.variant})
        except (TypeError, KeyError) as reason:
            raise ValueError(reason.args[0]) from reason

    def spec(self) -> EnvSpec:
        """Its sizes. Raises ValueError as `make` does."""
        return self.make().env_spec

    def policy(self, given: str) -> "Policy | PolicyFile":
        """What acts for observations of one world or of many: "trained" is the policy that ships, anything else a file
        or a run's folder. Raises ValueError unless there is one that fits."""
        spec = self.spec()
        if given == TRAINED:
            shipped = policy(self.id)
            shipped.require_fit(spec)
            return shipped
        from manyhands.training.evaluation import policy_for

        return policy_for(Path(given), spec)

    def expert(self) -> Expert:
        """A scripted policy for an episode. Raises ValueError if there is none."""
        control = self.variant["control_type"]
        if control != "ee":
            raise ValueError(
                f"the scripted expert of {self.variant['task']} moves the hand by control 'ee', not by {control!r}: "
                "give a --policy that was learned with it"
            )
        return Expert(self.id)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What says how an environment is made."""
    group = parser.add_argument_group("environment")
    group.add_argument("--robot", metavar="NAME", help="panda, arm6, or an arm and a gripper as six_axis+two_finger")
    group.add_argument("--control", metavar="TYPE", help=f"what actions mean: {', '.join(control_types())}")
    group.add_argument(
        "--option", action="append", metavar="NAME=VALUE",
        help="another argument of gymnasium.make, as object_shape=cylinder; may be given more than once",
    )  # fmt: skip


def given_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """The options among parsed arguments. Raises ValueError on what is none."""
    named = {"robot": arguments.robot, "control_type": arguments.control}
    return {name: value for name, value in named.items() if value is not None} | _parse(arguments.option or [])


def _parse(assignments: Sequence[str]) -> dict[str, Any]:
    """Options from texts such as "n_substeps=40" and "object_shape=cylinder"."""
    options: dict[str, Any] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals or not name:
            raise ValueError(f"{assignment!r} is no option, expected NAME=VALUE, {_EXAMPLE}")
        if name in ("render_mode", "task"):
            raise ValueError(f"{name} is no option of this command, which chooses it by itself; leave it out")
        options[name] = _value(name, text)
    return options


def _value(name: str, text: str) -> Any:
    """JSON, or else the text itself."""
    try:
        value = json.loads(text)
    except json.JSONDecodeError:
        return text
    return [_obstacle(each) for each in value] if name == "obstacles" and isinstance(value, list) else value


def _obstacle(given: Any) -> Obstacle:
    try:
        return Obstacle(**given)
    except TypeError as reason:
        example = '--option \'obstacles=[{"shape": "sphere", "size": 0.05, "position": [0.1, 0, 0.2]}]\''
        raise ValueError(f"{given!r} is no obstacle ({reason}); write {example}") from reason
