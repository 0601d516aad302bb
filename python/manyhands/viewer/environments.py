"""Environments on a page, and who acts in them."""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from manyhands import rotations
from manyhands._core import Geom, Model, World
from manyhands.measures import chain, hand_of
from manyhands.viewer.protocols import Watchable
from manyhands.viewer.sources import BodiesOfWorld, Marker, SimulationSource, Source

Array = NDArray[np.float64]

_UNTURNED, _ABOVE = np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.0, 0.0, 0.06])
_REST = 1.0  # [s] for which the end of an episode is looked at
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3}


@dataclass
class Outcome:
    """What an environment said after a step."""

    observation: Any = None
    reward: float = 0.0
    success: bool = False
    length: int = 0
    """Steps of the episode."""
    total: float = 0.0
    """The sum of its rewards."""
    ended: bool = False
    """Whether the episode is over."""
    episodes: int = 0
    """How many are over, this one included."""
    successes: int = 0
    """How many of them ended with success."""


class EnvSource(Source):
    """An environment, and who acts in it.

    `policy` takes what the environment said last and gives an action; None leaves the joints to the page's sliders.
    The step after the end of an episode begins the next one.
    """

    def __init__(self, env: gymnasium.Env[Any, Any], title: str) -> None:
        super().__init__()
        self.env, self.title = env, title
        self.policy: Callable[[Outcome], Any] | None = None
        self.limit = self.max_steps
        """Steps after which an episode is over; None without a limit."""
        self.ends = True
        """Whether an episode that is over is followed by another; otherwise it goes on."""
        self.on_step: list[Callable[[Any, Outcome], None]] = []
        self.on_reset: list[Callable[[Outcome], None]] = []
        self.outcome = Outcome(self.observe())

    def observe(self) -> Any:
        """What the environment would say now."""
        inner: Any = self.env.unwrapped
        return inner.observe()

    @property
    def env_id(self) -> str:
        """As gymnasium knows it, else the page's title."""
        return self.title if self.env.spec is None else self.env.spec.id

    @property
    def action_size(self) -> int:
        """Length of an action."""
        shape = self.env.action_space.shape
        assert shape is not None
        return shape[0]

    @property
    def max_steps(self) -> int | None:
        """What limits an episode where the environment was learned in; None if nothing does."""
        spec = self.env.spec
        return None if spec is None else spec.max_episode_steps

    @property
    def control_type(self) -> str:
        """What actions mean: "ee" and others move, and maybe turn, the hand; those that begin with "joint" move joints
        one by one."""
        inner: Any = self.env.unwrapped
        return getattr(getattr(inner, "robot", inner), "control_type", "")

    @property
    def has_grip(self) -> bool:
        """Whether the last number of an action opens the gripper."""
        if not self.control_type.startswith("joint"):
            return self.action_size in (4, 7)
        hand = hand_of(self.model)
        return hand is not None and self.action_size > len(chain(self.model, hand))

    def step(self) -> None:
        """One step of the environment under the policy's action, or the beginning of the next episode."""
        self.rest = 0.0
        if self.policy is None:
            self._step_freely()
            return
        before = self.outcome
        if before.ended and self.ends:
            self.reset()
            return
        action = np.asarray(self.policy(before), np.float32)
        observation, reward, terminated, truncated, info = self.env.step(action)
        success, length = bool(info.get("is_success")), before.length + 1
        is_late = self.limit is not None and length >= self.limit
        ended = before.ended or terminated or truncated or is_late
        ends_now = ended and not before.ended
        self.outcome = Outcome(
            observation, float(reward), success, length, before.total + float(reward), ended,
            before.episodes + ends_now, before.successes + (ends_now and success),
        )  # fmt: skip
        if ends_now and self.ends:
            self.rest = _REST
        for tell in self.on_step:
            tell(action, self.outcome)

    def reset(self, seed: int | None = None) -> None:
        """Another episode."""
        observation, info = self.env.reset(seed=seed)
        self.begin(observation, info)

    def begin(self, observation: Any, info: dict[str, Any]) -> None:
        """An episode that began elsewhere."""
        before = self.outcome
        success = bool(info.get("is_success"))
        self.outcome = Outcome(observation, success=success, episodes=before.episodes, successes=before.successes)
        for tell in self.on_reset:
            tell(self.outcome)

    def count_anew(self) -> None:
        """Forgets the episodes that are over."""
        self.outcome = replace(self.outcome, episodes=0, successes=0)

    @abstractmethod
    def _step_freely(self) -> None:
        """Lets `dt` pass without an action."""


class DropInSource(EnvSource, BodiesOfWorld):
    """An environment of `manyhands.panda_gym`: a world in double precision that may be pushed and pulled."""

    def __init__(self, env: gymnasium.Env[Any, Any], title: str) -> None:
        super().__init__(env, title)
        inner: Any = env.unwrapped  # a RobotTaskEnv
        self._task, self._shown = inner.task, SimulationSource(inner.sim, title)
        assert self._shown.world is not None and self._shown.joints is not None
        self.take(self._shown.world, self._shown.joints)
        self.dt, self.pushes, self.background = self._shown.dt, self._shown.pushes, self._shown.background

    def markers(self) -> list[Marker]:
        return self._shown.markers()

    def reset(self, seed: int | None = None) -> None:
        super().reset(seed)
        self._drive.release()

    def save(self) -> Any:
        return self._shown.save(), self._task.goal, self.outcome

    def restore(self, state: Any) -> None:
        shown, goal, self.outcome = state
        self._shown.restore(shown)
        self._task.goal = None if goal is None else goal.copy()

    def _step_freely(self) -> None:
        self._shown.step()


class NativeSource(EnvSource):
    """An environment that is stepped in C++: watched, played and rewound, but not pushed."""

    def __init__(self, env: gymnasium.Env[Any, Any], title: str) -> None:
        super().__init__(env, title)
        inner: Any = env.unwrapped
        self._inner: Watchable = inner
        self.dt = self._inner.dt
        self._bodies = self._inner.bodies
        self._model = self._bodies.model
        self._steps = 0

    @property
    def model(self) -> Model:
        return self._model

    @property
    def q(self) -> Array:
        return self._bodies.configuration()

    @property
    def time(self) -> float:
        return self._steps * self.dt

    def markers(self) -> list[Marker]:
        return goal_markers(self._model, self._inner.observe()["desired_goal"].astype(np.float64))

    def step(self) -> None:
        super().step()
        self._steps += 1

    def tick(self) -> None:
        self._steps += 1

    def save(self) -> Any:
        return self._inner.save_state(), self._steps, self.outcome

    def restore(self, state: Any) -> None:
        saved, self._steps, self.outcome = state
        self._inner.restore_state(saved)

    def _step_freely(self) -> None:
        """Without an action there is nothing that could pass here."""


def source_of_environment(env: Any, title: str = "") -> EnvSource | None:
    """What shows an environment; None of a kind that there is no way to show."""
    if not isinstance(env, gymnasium.Env):
        return None
    name = title or (env.spec.id if env.spec is not None else type(env.unwrapped).__name__)
    inner: Any = env.unwrapped
    if isinstance(getattr(getattr(inner, "sim", None), "world", None), World):
        return DropInSource(inner, name)
    if isinstance(inner, Watchable):
        return NativeSource(env.unwrapped, name)
    return None


def goal_markers(model: Model, goal: Array) -> list[Marker]:
    """Where objects are to be, as the goals (3), (6) or (4) of the package's tasks mean it."""
    objects = [geom for geom in model.geoms if geom.name.startswith("object")]
    if not objects:
        return [Marker("target", "sphere", (0.02,), (0.1, 0.9, 0.1, 0.3), goal[:3], _UNTURNED)]
    if len(goal) == 4:  # an orientation, shown above the object's place
        return [_marker(objects[0], _ABOVE, goal)]
    return [_marker(geom, goal[3 * k : 3 * k + 3], _UNTURNED) for k, geom in enumerate(objects)]


def _marker(geom: Geom, position: Array, quaternion: Array) -> Marker:
    """Where a geom is to be whose link is to come to a pose."""
    r, g, b = geom.rgba[:3]
    size = tuple(geom.size[: _SIZES[geom.shape]])
    place = position + rotations.rotate(quaternion, geom.position)
    turned = rotations.multiply(quaternion, geom.quaternion)
    return Marker(f"target {geom.name}", geom.shape, size, (r, g, b, 0.3), place, turned)
