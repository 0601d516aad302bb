"""Policies that act, by networks that C++ runs: nothing but numpy is needed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands._core.envs import EnvSpec, make_env_batch
from manyhands._core.learn import EvalResult, PolicyRunner, read_policy
from manyhands.env_names import resolve_env_id
from manyhands.policies.card import Card, read_card

_FOLDER = Path(__file__).parent
_INPUTS = ("observation", "achieved_goal", "desired_goal")
_WORLDS = 256  # that an evaluation steps at a time


def policy_ids() -> list[str]:
    """The environments for which a trained policy ships."""
    return sorted(path.stem for path in _FOLDER.glob("*.yaml"))


def policy(env_id: str) -> "Policy":
    """The trained policy of an environment, with or without its version. Raises ValueError where there is none, and
    TypeError on what is no name."""
    name = resolve_env_id(env_id)
    if name not in policy_ids():
        raise ValueError(
            f"no trained policy ships for {name}, but for {', '.join(policy_ids())}; train one: manyhands train {name}"
        )
    card = read_card(_FOLDER / f"{name}.yaml")
    return Policy(_FOLDER / card.file, card)


class Policy:
    """A trained policy: `policy(observation)` is the action, always the same for the same observation."""

    def __init__(self, path: str | Path, card: Card | None = None) -> None:
        """path: an ONNX file that `manyhands train` wrote. Raises ValueError on anything else.

        card: what is known of it, if that does not lie beside it.
        """
        self.path = Path(path)
        self.arrays = read_policy(self.path)
        """The network, as arrays."""
        if self.arrays.goal_dim == 0:
            raise ValueError(f"{path} is of an environment without goals, whose policies manyhands.learn loads")
        self._runner = PolicyRunner(self.arrays)
        self._card = card

    @property
    def cameras(self) -> dict[str, Any]:
        """Through which it sees: it has none, and knows the state."""
        return {}

    @property
    def env_id(self) -> str:
        """The environment that it was learned in."""
        return self.arrays.env_id if self._card is None else self._card.environment

    @property
    def card(self) -> Card:
        """How well it does, and where it comes from. Raises FileNotFoundError if no card lies beside the file."""
        if self._card is None:
            self._card = read_card(self.path.with_suffix(".yaml"))
        return self._card

    def __call__(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """(action_dim,) for a single observation, (num_envs, action_dim) for those of a vector environment; in [-1, 1].

        Raises ValueError on what is no observation of the task.
        """
        if not isinstance(observation, Mapping) or not observation.keys() >= set(_INPUTS):
            found = (
                ", ".join(map(repr, observation)) if isinstance(observation, Mapping) else type(observation).__name__
            )
            raise ValueError(f"{self._expected()}, not {found}")
        rows = [np.ascontiguousarray(observation[name], np.float32) for name in _INPUTS]
        goal = self.arrays.goal_dim
        shapes = [(*rows[0].shape[:-1], size) for size in (self.arrays.observation_dim, goal, goal)]
        if [row.shape for row in rows] != shapes or rows[0].ndim not in (1, 2):
            raise ValueError(f"{self._expected()}, not of shapes {', '.join(str(row.shape) for row in rows)}")
        actions = self._runner.act(*(np.atleast_2d(row) for row in rows))
        return actions if rows[0].ndim == 2 else actions[0]

    def evaluate(
        self, env_id: str = "", episodes: int = 1000, first_seed: int = 2 * 10**9, num_threads: int | None = None
    ) -> EvalResult:
        """Runs episodes in C++, environments and networks alike; episode k starts from seed first_seed + k.

        env_id: that of the policy if empty. Raises ValueError if the policy does not fit the environment.
        """
        worlds = max(1, min(episodes, _WORLDS))
        envs = make_env_batch(resolve_env_id(env_id or self.env_id), worlds, num_threads=num_threads or 0)
        return self._runner.evaluate(envs, episodes, first_seed)

    def require_fit(self, spec: EnvSpec) -> None:
        """Raises ValueError unless rows and actions are as long as the environment's."""
        own = (self.arrays.observation_dim, self.arrays.goal_dim, self.arrays.action_dim)
        its = (spec.observation_dim, spec.goal_dim, spec.action_dim)
        if own != its:
            raise ValueError(
                f"the policy of {self.env_id} does not fit {spec.id}: observation, goal and action are {own} numbers "
                f"long, expected {its}"
            )

    def __getstate__(self) -> dict[str, Any]:
        return {"path": self.path, "arrays": self.arrays}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._runner = PolicyRunner(self.arrays)

    def __repr__(self) -> str:
        return f"<manyhands.policies.Policy of {self.env_id}: {self.path}>"

    def _expected(self) -> str:
        sizes = (self.arrays.observation_dim, self.arrays.goal_dim, self.arrays.goal_dim)
        named = ", ".join(f"{name!r} ({size},)" for name, size in zip(_INPUTS, sizes, strict=True))
        return f"the policy of {self.env_id} expects a dict with {named}, or with a first axis for the worlds"
