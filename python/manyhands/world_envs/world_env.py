"""What an environment on a world of one's own is derived from."""

import math
from abc import abstractmethod
from collections import deque
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from manyhands._core import Model, ModelBuilder, SimulationError, World
from manyhands._core.render import Look
from manyhands.envs.cameras import FINE, orbit_camera, require_mode
from manyhands.envs.page import Page
from manyhands.envs.spaces import warn_modeless, warn_unstable
from manyhands.world_envs.variation import NOTHING_VARIED, Range, Variation, vary_world

Row = NDArray[np.float32]
Array = NDArray[np.float64]

_LARGEST = 10.0  # of an observation's numbers: beyond it they are clipped


class View(NamedTuple):
    """Where pictures are taken from."""

    target: tuple[float, float, float]
    """[m]"""
    distance: float
    """[m]"""
    yaw: float
    """[degrees]; at 0 the camera looks along y."""
    pitch: float
    """[degrees]; a negative one looks down."""


class WorldEnv(gymnasium.Env[Row, Row]):
    """A world, and what is asked of it. A derived class makes the world, and says four things of it: how an episode
    begins (`begin`), what an action does (`act`), what is seen (`look`), and what it is worth (`judge`).

    Actions lie in [-1, 1] and are clipped to it; observations lie in [-10, 10], in SI units. All that happens follows
    from the seed. `info["is_success"]` says whether the task is done; with `randomize`, `info["randomized"]` what
    the episode has. `gymnasium.make` limits the length of episodes.
    """

    action_space: spaces.Box
    observation_space: spaces.Box
    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["human", "rgb_array"], "render_fps": 25}  # pyright: ignore[reportIncompatibleVariableOverride]

    def __init__(
        self,
        world: World,
        *,
        actions: int,
        observations: int,
        substeps: int,
        view: View,
        render_mode: str | None = None,
        randomize: Mapping[str, Range] | None = None,
    ) -> None:
        """world: as every episode finds it, before `begin`. actions, observations: how many numbers they have.
        substeps: of the world in a step. randomize: what differs from episode to episode, see `variation.RANGES`.

        Raises ValueError on an unknown render mode, or what cannot be randomised so.
        """
        require_mode(render_mode, self.metadata["render_modes"])
        self.world, self.substeps = world, substeps
        self.model: Model = world.model
        self.dt = substeps * world.time_step
        """What a step takes [s]."""
        vars(self)["metadata"] = {**self.metadata, "render_fps": round(1 / self.dt)}
        self.render_mode = render_mode
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), np.float32)  # pyright: ignore[reportIncompatibleVariableOverride]
        self.observation_space = spaces.Box(-_LARGEST, _LARGEST, (observations,), np.float32)  # pyright: ignore[reportIncompatibleVariableOverride]
        self.varied = NOTHING_VARIED
        """What this episode has; `act` multiplies the largest forces of its motors by `varied["motor_force"]`."""
        self._view, self._page = view, Page()
        self._variation = Variation(randomize or {})
        self._start = world.snapshot()
        self._noise = np.random.default_rng(0)
        self._delayed: deque[Array] = deque()

    @abstractmethod
    def begin(self) -> None:
        """Puts things where the episode begins, by draws from `np_random`; the world is as it was made."""

    @abstractmethod
    def act(self, action: Array) -> None:
        """Does what an action says, and steps the world `substeps` times."""

    @abstractmethod
    def look(self) -> Array:
        """What is observed."""

    @abstractmethod
    def judge(self, action: Array) -> tuple[float, bool, dict[str, Any]]:
        """After an action: reward, whether the episode is over, and `info`."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Row, dict[str, Any]]:
        """Starts an episode. The same seed gives the same one; without a seed the stream goes on."""
        super().reset(seed=seed)
        (self._noise,) = self.np_random.spawn(1)  # of its own: places are the same, whatever else is random
        self.varied = self._variation.draw(self._noise)
        self.world.restore(self._start)
        vary_world(self.world, self.varied)
        self._delayed = deque([np.zeros(self.action_space.shape)] * round(self.varied["action_latency"]))
        self.begin()
        if self.render_mode == "human":
            self.render()
        return self._observe(), self._info({"is_success": False})

    def step(self, action: ArrayLike) -> tuple[Row, float, bool, bool, dict[str, Any]]:
        """One step. Raises ValueError on a wrong shape or a NaN. Where the world cannot go on, `info["unstable"]` is
        True and the episode is truncated."""
        self._delayed.append(self._as_action(action))
        done = self._delayed.popleft()
        unstable = False
        try:
            self.act(done)
        except SimulationError:
            unstable = True
            warn_unstable()
        reward, terminated, info = self.judge(done)
        if self.render_mode == "human":
            self.render()
        return self._observe(), reward, terminated, unstable, self._info({**info, "unstable": unstable})

    def render(self) -> NDArray[np.uint8] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """ "rgb_array": (480, 720, 3) uint8. "human" shows the world on a page in the browser, in real time."""
        if self.render_mode == "human":
            self._page.show(self)
            return None
        if self.render_mode is None:
            warn_modeless("make")
            return None
        target, distance, yaw, pitch = self._view
        camera = orbit_camera(720, 480, target, distance, yaw + math.degrees(self.varied["camera"]), pitch, 0.0)
        look = Look(**FINE, sun=0.72 * self.varied["light"])
        return self.world.render(camera, look=look, depth=False, segmentation=False).colour

    def close(self) -> None:
        """Takes the page away; may be called again."""
        self._page.close()

    def draw_target(self, low: ArrayLike, high: ArrayLike) -> Array:
        """A place between two, evenly; with `randomize={"target": s}`, in the share s of it about the middle."""
        middle, half = np.add(low, high) / 2, np.subtract(high, low) / 2
        return middle + self.varied["target"] * half * self.np_random.uniform(-1, 1, middle.shape)

    def _as_action(self, action: ArrayLike) -> Array:
        numbers = np.asarray(action, np.float64)
        if numbers.shape != self.action_space.shape or np.isnan(numbers).any():
            raise ValueError(f"the action is {action!r}, expected {len(self.action_space.low)} numbers in [-1, 1]")
        return numbers.clip(-1, 1)

    def _observe(self) -> Row:
        numbers = self.look()
        if self.varied["observation_noise"]:
            numbers = numbers + self.varied["observation_noise"] * self._noise.standard_normal(numbers.shape)
        return numbers.clip(-_LARGEST, _LARGEST).astype(np.float32)

    def _info(self, info: dict[str, Any]) -> dict[str, Any]:
        if self._variation.names:
            info["randomized"] = {name: self.varied[name] for name in self._variation.names}
        return info


def marker(name: str, radius: float = 0.02, rgba: ArrayLike = (0.1, 0.85, 0.2, 0.5)) -> ModelBuilder:
    """A ball that is seen and touches nothing, to be put anywhere by `World.set_mocap(name, position)`."""
    builder = ModelBuilder(name)
    builder.add_link(name)
    builder.add_joint(f"{name}_place", "mocap", "world", name)
    builder.add_geom(name, "sphere", radius, visual=True, rgba=rgba)
    return builder
