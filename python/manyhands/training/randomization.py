"""How a policy does where robot and objects differ from episode to episode: success over each range."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import make_env_batch
from manyhands.envs import transfer_ranges
from manyhands.envs.spaces import as_range
from manyhands.policies import Policy
from manyhands.training.evaluation import PolicyFile
from manyhands.training.settings import FIRST_EVALUATION_SEED, TrainSettings

_MORE_STEPS = 6  # than without, at most
WHOLE = ("action_latency",)  # what is drawn in whole numbers
_Z = 1.96  # of a 95 % interval
_EPISODES = 2000  # after training: 200 in each of ten bins, whose success is known within seven points


def randomized(settings: TrainSettings, overrides: Mapping[str, Any], max_env_steps: int | None) -> TrainSettings:
    """The settings of a run under the ranges of transfer; `overrides` and `max_env_steps` are the user's own.

    There is more to learn, and an expert does not know of delays: critics judge its answers.
    """
    judged = settings.overrides.get("cloning_weight", 0) > 0 and settings.overrides.get("algorithm", "TD3") == "TD3"
    added = {"privileged_critic": True} | ({"cloning_filter": True} if judged else {})
    return replace(
        settings,
        randomize=transfer_ranges(settings.env_id),
        overrides={**settings.overrides, **added, **overrides},
        max_env_steps=max_env_steps or _MORE_STEPS * settings.max_env_steps,
    )


@dataclass(frozen=True)
class Bin:
    """Episodes whose value lies in one part of a range."""

    low: float
    high: float
    episodes: int
    success: float
    interval: tuple[float, float]
    """95 %, by Wilson."""


@dataclass(frozen=True)
class RandomizedRun:
    """n episodes, each under other values."""

    ranges: dict[str, tuple[float, float, bool]]
    """Of each name: least, most, and whether the logarithm is uniform."""
    values: dict[str, NDArray[np.float32]]
    """(n) each"""
    success: NDArray[np.bool_]
    """(n), at the end of the episode."""

    def bins(self, name: str, count: int) -> list[Bin]:
        """Success over equal parts of a range; of whole numbers over each of them."""
        low, high, logarithmic = self.ranges[name]
        if name in WHOLE:
            edges = np.arange(low, high + 2) - 0.5
        else:
            edges = np.geomspace(low, high, count + 1) if logarithmic else np.linspace(low, high, count + 1)
        part = np.clip(np.searchsorted(edges, self.values[name], "right") - 1, 0, len(edges) - 2)
        return [self._bin(edges[k], edges[k + 1], self.success[part == k]) for k in range(len(edges) - 1)]

    @staticmethod
    def _bin(low: float, high: float, success: NDArray[np.bool_]) -> Bin:
        n = len(success)
        rate = float(success.mean()) if n else float("nan")
        return Bin(float(low), float(high), n, rate, wilson(rate, n))

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "episodes": len(self.success),
            "success_rate": float(self.success.mean()),
            "ranges": {name: [vars(one) for one in self.bins(name, 5)] for name in self.ranges},
        }


def wilson(rate: float, n: int) -> tuple[float, float]:
    """The 95 % interval of a rate of n independent trials (Wilson, 1927)."""
    if n == 0:
        return 0.0, 1.0
    centre = (rate + _Z**2 / (2 * n)) / (1 + _Z**2 / n)
    half = _Z / (1 + _Z**2 / n) * np.sqrt(rate * (1 - rate) / n + _Z**2 / (4 * n**2))
    return float(max(centre - half, 0.0)), float(min(centre + half, 1.0))


def run_randomized(
    policy: PolicyFile | Policy,
    env_id: str,
    ranges: Mapping[str, Any],
    episodes: int = _EPISODES,
    first_seed: int = FIRST_EVALUATION_SEED,
    num_threads: int | None = None,
) -> RandomizedRun:
    """Runs episodes; the k-th starts from seed first_seed + k. Raises ValueError on ranges that make no sense."""
    if episodes < 1:
        raise ValueError(f"episodes is {episodes}, expected a positive number")
    given = [as_range(name, value) for name, value in ranges.items()]
    if not given:
        raise ValueError(f"nothing of {env_id} is randomised: there is no range to look at")
    envs = make_env_batch(env_id, episodes, num_threads=num_threads or 0, randomize=given)
    envs.reset(seeds=np.arange(first_seed, first_seed + episodes, dtype=np.uint64))
    values = dict(zip(envs.spec.randomized, envs.randomized.T, strict=True))
    running, success = np.ones(episodes, np.bool_), np.zeros(episodes, np.bool_)
    for _ in range(envs.spec.max_episode_steps):
        names = ("observation", "achieved_goal", "desired_goal")
        envs.step(policy(dict(zip(names, envs.observations(), strict=True))))
        ended = running & (envs.terminated | envs.truncated)
        success[ended] = envs.is_success[ended]
        running &= ~ended
        if not running.any():
            break
    success[running] = envs.is_success[running]
    return RandomizedRun({name: (low, high, log) for name, low, high, log in given}, values, success)


def table(run: RandomizedRun) -> str:
    """Success in each fifth of every range, from its low end to its high one; of latencies for each."""
    width = max(map(len, run.ranges))
    lines = []
    for name, (low, high, _) in run.ranges.items():
        rates = "  ".join(f"{one.success:6.1%}" for one in run.bins(name, 5))
        lines.append(f"  {name:<{width}}  {f'{low:g} to {high:g}':<12}  {rates}")
    return "\n".join(lines)
