"""What a training run is made from."""

import difflib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from manyhands._core.envs import expert_ids
from manyhands._core.learn import TrainerConfig
from manyhands.arguments import as_whole, whole_number
from manyhands.envs.spaces import as_range

KINDS = {bool: "true or false", int: "a whole number", float: "a number", str: "a text", list: "a list in brackets"}
MOST = 2**31 - 1  # of what is counted
FIRST_EVALUATION_SEED = 10**9  # of the last evaluation: training draws its seeds from all 64-bit numbers by hash


def require_setting(name: str) -> Any:
    """The default of one of the trainer's settings; the seed is the run's. Raises ValueError if there is none."""
    known = TrainerConfig().to_dict()
    if name == "seed":
        raise ValueError("'seed' is no trainer setting: --seed sets it, and --seeds N has a sweep train 0 to N - 1")
    if name not in known:
        names = sorted(known.keys() - {"seed"})
        near = difflib.get_close_matches(name, names)
        hint = f"did you mean {', '.join(near)}?" if near else f"there are {', '.join(names)}"
        raise ValueError(f"{name!r} is no trainer setting; {hint}")
    return known[name]


def parse_overrides(assignments: Sequence[str]) -> dict[str, Any]:
    """Trainer settings from texts such as "gamma=0.9" and "hidden_layers=[128, 128]". Raises ValueError."""
    overrides: dict[str, Any] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise ValueError(f"{assignment!r} is no setting, expected NAME=VALUE, for example gamma=0.9")
        known = require_setting(name)
        if isinstance(known, str):
            overrides[name] = text
            continue
        try:
            overrides[name] = json.loads(text)
        except json.JSONDecodeError as error:
            raise ValueError(f"{assignment!r}: {text!r} is no number, list, true or false") from error
    return overrides


def override(config: TrainerConfig, name: str, value: Any) -> None:
    """Sets one trainer setting; whole numbers may be written as 1e4. Raises ValueError on another type."""
    kind = type(getattr(config, name))
    given = as_whole(value) if kind is int else value
    try:
        setattr(config, name, given)
    except TypeError as error:
        limits = f" from {-MOST - 1} to {MOST}" if kind is int and type(given) is int else ""
        raise ValueError(f"the trainer setting {name} is {given!r}, expected {KINDS[kind]}{limits}") from error


def shares_of(worlds: int, workers: int) -> list[int]:
    """Worlds of each worker, as equal as whole numbers can be."""
    return [worlds // workers + (i < worlds % workers) for i in range(workers)]


@dataclass(frozen=True)
class TrainSettings:
    """Everything from which a run follows; the same settings give the same policy on the same build."""

    env_id: str
    seed: int = 0
    num_envs: int = 64  # worlds stepped at a time
    num_threads: int | None = None  # None: MANYHANDS_THREADS, or the machine's cores
    max_env_steps: int = 1_000_000  # over all worlds, if the task is not solved before
    evaluation_episodes: int = 1000  # after training
    workers: int | None = None  # of a Ray cluster, which share the worlds; None: they are all here
    overrides: dict[str, Any] = field(default_factory=dict)  # trainer settings that differ from their defaults
    randomize: dict[str, Any] = field(default_factory=dict)  # what differs from episode to episode, and its ranges
    cameras: dict[str, Any] = field(default_factory=dict)  # through which the policy sees, as environments take them

    def __post_init__(self) -> None:
        for name in ("num_envs", "max_env_steps", "evaluation_episodes"):
            whole_number(name, getattr(self, name), 1)
        whole_number("seed", self.seed, 0, 2**63 - 1)
        if self.num_threads is not None:
            whole_number("num_threads", self.num_threads, 1, 1024)
        if self.workers is not None:
            whole_number("workers", self.workers, 1, self.num_envs)
        if not isinstance(self.env_id, str):
            raise ValueError(f"env_id is {self.env_id!r}, expected a name")
        if not isinstance(self.overrides, dict):
            raise ValueError(f"overrides is {self.overrides!r}, expected names and values")
        if not isinstance(self.randomize, dict):
            raise ValueError(f"randomize is {self.randomize!r}, expected names and ranges")
        if not isinstance(self.cameras, dict):
            raise ValueError(f"cameras is {self.cameras!r}, expected names and options")

    @property
    def ranges(self) -> list[tuple[str, float, float, bool]]:
        """`randomize` as batches take it. Raises ValueError on a range that is none."""
        return [as_range(name, value) for name, value in self.randomize.items()]

    def trainer_config(self) -> TrainerConfig:
        """The trainer's config. Raises ValueError on an override that makes no sense."""
        config = TrainerConfig()
        config.seed = self.seed
        if self.num_threads is not None:
            config.num_threads = self.num_threads
        for name, value in self.overrides.items():
            override(config, name, value)
        config.validate()
        if config.privileged_critic and not self.randomize:
            raise ValueError(f"privileged_critic needs {self.env_id} to be randomised: add --randomize")
        if self.cameras and config.algorithm != "DAgger":
            raise ValueError(
                f"algorithm is {config.algorithm}, and there are cameras: only DAgger learns from pictures"
            )
        if self.cameras and self.workers is not None:
            raise ValueError("workers take no pictures: train without --ray, or without cameras")
        if self.cameras and self.randomize:
            raise ValueError("what is randomised is not looked at through cameras: train without one or the other")
        if config.wants_expert and self.env_id not in expert_ids():
            raise ValueError(f"there is no expert for {self.env_id!r}: set expert_rate and cloning_weight to 0")
        if self.workers is not None and config.algorithm == "PPO":
            raise ValueError("PPO learns from what its present policy does, which workers do not know: use TD3 or SAC")
        return config
