"""Many environments, stepped together in C++."""

from collections.abc import Sequence
from typing import Any
from weakref import WeakMethod

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from manyhands._core.envs import AutoresetBatch, EnvBatch, EnvBodies
from manyhands._core.envs import AutoresetMode as CoreMode
from manyhands.arguments import MOST_THREADS, whole_number
from manyhands.envs import spaces
from manyhands.envs.cameras import RENDER_MODES, EnvCameras, require_mode
from manyhands.envs.page import Page
from manyhands.envs.spaces import ControlType, EnvOptions, Observation, RewardType
from manyhands.envs.tally import Tally
from manyhands.envs.turn import Turn

_MADE_ANEW = "_batch", "_bodies", "_cameras", "_envs", "_page", "_tally", "_turn"  # in a copy
_MOST_WORLDS = 2**20


class ArmVectorEnv(VectorEnv[Observation, NDArray[np.float32], NDArray[Any]]):
    """`num_envs` worlds of one task: what SyncVectorEnv gives over as many `ArmEnv`, to the bit, but fast.

    Made by `gymnasium.make_vec("PandaReach-v3", num_envs=4096, num_threads=2, autoreset_mode="SameStep")`. Arrays are
    as in `ArmEnv` with a first axis for the worlds. The results do not depend on the number of threads.
    Calls from several Python threads take turns. Copies and pickles continue where the environment is.
    """

    def __init__(
        self,
        num_envs: int = 1,
        task: str = "PandaReach",
        *,
        reward_type: RewardType = "sparse",
        control_type: ControlType = "ee",
        max_episode_steps: int | None = None,
        num_threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        render_mode: str | None = None,
        render_tiles: bool = True,
        **options: Unpack[EnvOptions],
    ) -> None:
        """Makes the worlds.

        num_envs: 1 to 1048576.
        max_episode_steps: truncates episodes; None takes the limit of the task, -1 none.
        num_threads: None takes the variable MANYHANDS_THREADS, or as many as the machine has cores.
        copy: False returns observations as read-only views that the next step or reset overwrites.

        render_mode: "human" shows a world, to be chosen, on a page in the browser: steps keep real time and wait while
        the page is paused, as it is set there, but never for a browser. Needs the extra `viewer`.

        render_tiles: False makes `render` give a tuple of pictures, as Gymnasium's vector wrappers expect.

        options: those of `spaces.EnvOptions`.

        Raises ValueError on a number out of range, or an unknown task, type or mode, TypeError on an unknown
        option or one of another type.
        """
        num_envs = whole_number("num_envs", num_envs, 1, _MOST_WORLDS)
        threads = 0 if num_threads is None else whole_number("num_threads", num_threads, 1, MOST_THREADS)
        if max_episode_steps is not None:
            max_episode_steps = whole_number("max_episode_steps", max_episode_steps, -1, 2**31 - 1)
            if max_episode_steps == 0:
                raise ValueError("max_episode_steps is 0, expected 1 or more, or -1 for no limit")
        mode = AutoresetMode(autoreset_mode)
        self._arguments = {
            "num_envs": num_envs,
            "task": task,
            "reward_type": reward_type,
            "control_type": control_type,
            "max_episode_steps": max_episode_steps,
            "num_threads": num_threads,
            "autoreset_mode": mode,
            "render_mode": render_mode,
            **options,
        }
        self._envs = spaces.make_batch(task, reward_type, control_type, num_envs, threads, options)
        spec = self._envs.spec
        limit = spec.max_episode_steps if max_episode_steps is None else max(max_episode_steps, 0)
        self._batch = AutoresetBatch(self._envs, CoreMode[mode.name], limit)
        self._turn = Turn()
        self._copy = copy
        self._was_reset = False
        self.num_envs = num_envs
        self.render_mode = render_mode
        modes = ["human", *RENDER_MODES]
        require_mode(render_mode, modes)
        self.metadata = {"render_modes": modes, "render_fps": spaces.RENDER_FPS, "autoreset_mode": mode}
        self._page = Page()
        self._bodies: EnvBodies | None = None
        self._tally: Tally | None = None
        self._cameras = EnvCameras(self._envs, None if render_mode == "human" else render_mode, options, threads)
        self._tiles = render_tiles
        pictures = self._cameras.spaces()
        if pictures:
            # The collector does not see what the batch holds: it must hold nothing that could lead back to it.
            keep = WeakMethod(self._cameras.keep_final)
            self._batch.on_final(lambda worlds: None if (see := keep()) is None else see(worlds))
        self.single_observation_space = spaces.observation_space(spec, pictures)
        self.single_action_space = spaces.action_space(spec)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def training_batch(self, num_threads: int | None = None) -> EnvBatch | None:
        """As many new worlds of it in C++, for a trainer; None if its episodes have a limit of their own."""
        own = dict(self._arguments)
        if own["max_episode_steps"] not in (None, self._envs.spec.max_episode_steps):
            return None
        task, reward_type, control_type = (own.pop(key) for key in ("task", "reward_type", "control_type"))
        for key in ("num_envs", "max_episode_steps", "num_threads", "autoreset_mode", "render_mode"):
            del own[key]
        return spaces.make_batch(task, reward_type, control_type, self.num_envs, num_threads or 0, own)  # pyright: ignore[reportArgumentType]

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts episodes in all worlds, or in those where options["reset_mask"] (num_envs,) is True.

        `seed` s seeds world i with s + i, a list each world on its own (None: its stream goes on). A world seeded so
        gives the same bits as a single environment reset with that seed. Raises ValueError on wrong lengths or seeds,
        TypeError on a mask that is no array of bool.
        """
        seeds = None if seed is None else self._seeds(seed)
        with self._turn:
            mask = self._reset_mask(options)
            if seeds is None:
                self._batch.reset(mask)
            else:
                seeded = np.array([one is not None for one in seeds])
                self._batch.reset(mask, spaces.as_seeds([0 if one is None else one for one in seeds]), seeded)
            self._was_reset = True
            if self._tally is not None:
                self._tally.reset(mask)
            observation, info = self._observation(), self._info(mask)
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(
        self, actions: ArrayLike
    ) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Steps all worlds under `actions` (num_envs, action_dim), clipped to [-1, 1].

        Returns (observation, reward, terminated, truncated, info). Finished worlds start anew as the autoreset mode
        says; in mode SAME_STEP info["final_obs"] and info["final_info"] hold the end of their episodes. A world whose
        numbers stopped being finite is truncated where this step began, and "unstable" in its info. Raises
        ValueError on a wrong shape or a NaN, RuntimeError in mode DISABLED if a finished world was not reset.
        """
        if not self._was_reset:
            raise ResetNeeded("call reset before the first step")
        spec = self._envs.spec
        checked = spaces.as_actions(spec, actions, (self.num_envs, spec.action_dim))
        with self._turn:
            self._batch.step(checked)
            observation, info = self._observation(), self._final_info() | self._info()
            if info.get("final_info", info)["unstable"].any():
                spaces.warn_unstable()
            reward, terminated, truncated = self._batch.outcome()
            if self._tally is not None:
                success = info.get("final_info", {}).get("is_success", info["is_success"])
                self._tally.step(reward, terminated | truncated, success)
        if self.render_mode == "human":
            self.render()
        return observation, reward, terminated, truncated, info

    def render(self) -> Any:
        """What the render mode says, of up to 64 worlds in tiles: "rgb_array" (height, width, 3) uint8, "depth_array"
        (height, width) float32 [m]. With `render_tiles=False` a tuple of such pictures, one for each world. "human"
        waits for real time, and while the page is paused."""
        if self.render_mode == "human":
            self._page.show(self)
            return None
        if self.render_mode is None:
            spaces.warn_modeless("make_vec")
            return None
        with self._turn:
            if self._tiles:
                return self._cameras.render()
            frames = self._cameras.frames(range(self.num_envs))
            return None if frames is None else tuple(frames)

    def close_extras(self, **_: Any) -> None:
        """Takes the page away."""
        self._page.close()

    @property
    def dt(self) -> float:
        """What a step takes [s]."""
        return self._envs.spec.dt

    @property
    def bodies(self) -> EnvBodies:
        """What is seen of the worlds: `bodies.model`, and `bodies.configuration(world)`, its q, between two steps."""
        if self._bodies is None:
            self._bodies = EnvBodies(self._envs)
        return self._bodies

    def see(self, worlds: Sequence[int]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Some worlds between two steps: q (n, nq) of `bodies.model`, and their goals (n, goal_dim)."""
        with self._turn:
            goals = self._batch.observations(False)[2][list(worlds)].astype(np.float64)
            return np.stack([self.bodies.configuration(world) for world in worlds]), goals

    def count_episodes(self) -> Tally:
        """What counts the episodes of all worlds from now on."""
        if self._tally is None:
            self._tally = Tally(self.num_envs, self.metadata["autoreset_mode"])
        return self._tally

    def save_state(self) -> bytes:
        """All that a run needs to continue bit for bit: physics, goals, random streams, and where each world is in its
        episode."""
        with self._turn:
            return self._batch.snapshot()

    def restore_state(self, state: bytes) -> Observation:
        """Goes back to a saved state and returns what is observed there. Raises ValueError on one of another task or
        number of worlds."""
        with self._turn:
            self._batch.restore(state)
            self._was_reset = True
            return self._observation()

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in vars(self).items() if name not in _MADE_ANEW}
        return {"kept": kept, "state": self.save_state()}

    def __setstate__(self, saved: dict[str, Any]) -> None:
        ArmVectorEnv.__init__(self, **saved["kept"]["_arguments"])
        vars(self).update(saved["kept"])
        self._batch.restore(saved["state"])

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any = None) -> Any:
        """The task's reward for goals (..., goal_dim): float32, a scalar or of shape (...). `info` is not used."""
        return spaces.compute_reward(self._envs, achieved_goal, desired_goal)

    def _seeds(self, seed: Any) -> Sequence[int | None]:
        if isinstance(seed, int | np.integer) and seed >= 0:
            return range(int(seed), int(seed) + self.num_envs)
        seeds: Any = seed
        is_list = isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str | bytes) and np.ndim(seeds) == 1
        if not is_list or not all(one is None or (isinstance(one, int | np.integer) and one >= 0) for one in seeds):
            raise ValueError(
                f"seed: expected a whole number of 0 or more, None, or a list of num_envs of them, not {seed!r}"
            )
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: {len(seeds)} are given for num_envs={self.num_envs} worlds, expected one for each")
        return seeds

    def _reset_mask(self, options: dict[str, Any] | None) -> NDArray[np.bool_] | None:
        mask = (options or {}).get("reset_mask")
        if mask is None:
            return None
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise TypeError("options['reset_mask'] must be a numpy array of bool")
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(f"options['reset_mask'] must have shape ({self.num_envs},) and at least one True")
        if not self._was_reset and not mask.all():
            raise ResetNeeded("reset all worlds before some of them")
        return mask

    def _observation(self) -> Observation:
        observation, achieved, desired = self._batch.observations(self._copy)
        rows = {"observation": observation, "achieved_goal": achieved, "desired_goal": desired}
        return rows | self._cameras.observe()

    def _info(self, mask: NDArray[np.bool_] | None = None) -> dict[str, Any]:
        present = np.ones(self.num_envs, np.bool_) if mask is None else mask.copy()
        return {
            "is_success": self._batch.is_success & present,
            "_is_success": present,
            "unstable": self._batch.unstable & present,
            "_unstable": present.copy(),
            **self._randomized(self._envs.randomized, present),
        }

    def _randomized(self, rows: NDArray[np.float32], present: NDArray[np.bool_]) -> dict[str, Any]:
        """What SyncVectorEnv makes of the dicts in the infos of single environments; `rows` (num_envs, names)."""
        values: dict[str, Any] = {}
        for name, column in zip(self._envs.spec.randomized, rows.T.astype(np.float64), strict=True):
            values[name] = np.where(present, column, 0.0)
            values[f"_{name}"] = present.copy()
        return {"randomized": values, "_randomized": present.copy()} if values else {}

    def _final_info(self) -> dict[str, Any]:
        rows = self._batch.final_rows()
        if rows is None:
            return {}
        worlds, observation, achieved, desired, is_success, unstable, randomized = rows
        present = np.zeros(self.num_envs, np.bool_)
        present[worlds] = True
        success, blown_up = np.zeros((2, self.num_envs), np.bool_)
        success[worlds], blown_up[worlds] = is_success, unstable
        values = np.zeros((self.num_envs, randomized.shape[1]), np.float32)
        values[worlds] = randomized
        final_obs = np.full(self.num_envs, None, dtype=object)
        for k, world in enumerate(worlds):
            final_obs[world] = {
                "observation": observation[k],
                "achieved_goal": achieved[k],
                "desired_goal": desired[k],
                **{name: pictures[k] for name, pictures in self._cameras.final.items()},
            }
        return {
            "final_obs": final_obs,
            "_final_obs": present,
            "final_info": {
                "is_success": success,
                "_is_success": present.copy(),
                "unstable": blown_up,
                "_unstable": present.copy(),
                **self._randomized(values, present),
            },
            "_final_info": present.copy(),
        }
