"""One environment."""

from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from manyhands._core.envs import EnvBatch, EnvBodies, EnvSpec
from manyhands.envs import spaces
from manyhands.envs.cameras import RENDER_MODES, EnvCameras, require_mode
from manyhands.envs.page import Page
from manyhands.envs.spaces import ControlType, EnvOptions, Observation, RewardType
from manyhands.envs.turn import Turn

_MADE_ANEW = "_batch", "_cameras", "_page", "_turn"  # in a copy


class ArmEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """A robot arm and a task, as panda-gym describes them; the arm is a Panda unless `robot` names another.

    Tasks: PandaReach, PandaPush, PandaSlide, PandaPickAndPlace, PandaStack, PandaFlip. Observations are dicts of
    float32 arrays: `observation` (observation_dim,), `achieved_goal` and `desired_goal` (goal_dim,), in SI units. An
    action (action_dim,) lies in [-1, 1] and is clipped to it. What it means is up to `control_type`:

    - "ee": displacement of the hand, which points straight down (3 numbers, unit 0.05 m);
    - "joints": displacement of the joints (one each, unit 0.05 rad);
    - "ee_pose": displacement of the hand, and its rotation vector from pointing straight down, about the world's axes
      (6, units 0.05 m and 90 degrees); an action turns the hand and each joint by 0.2 rad at most;
    - "joint_velocity": velocity of the joints (one each, unit 1 rad/s);
    - "joint_torque": torque beyond what holds the arm against gravity and Coriolis forces (one each, unit a tenth of
      the motor's largest);
    - "impedance": as "ee_pose", of the goal to which a spring and a damper pull the hand; the goal stays when the hand
      is pushed away.

    Where the task needs the gripper one more number opens it (unit 0.2 m). A step takes 0.04 s. An episode terminates
    with success; its length is limited by `gymnasium.make`.

    Calls from several Python threads take turns.

    `info["is_success"]` of reset and step says whether the goal is reached; with `randomize`, `info["randomized"]` what
    the episode has, by name. Copies and pickles continue where the environment is: those of an environment in
    Gymnasium's wrappers too, with the number of steps that its TimeLimit has counted.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["human", *RENDER_MODES], "render_fps": spaces.RENDER_FPS}  # pyright: ignore[reportIncompatibleVariableOverride]

    def __init__(
        self,
        task: str = "PandaReach",
        *,
        reward_type: RewardType = "sparse",
        control_type: ControlType = "ee",
        render_mode: str | None = None,
        **options: Unpack[EnvOptions],
    ) -> None:
        """`options` are those of `spaces.EnvOptions`.

        render_mode: "human" shows every step on a page in the browser, in real time; needs the extra `viewer`.

        Raises ValueError on an unknown task, type or render mode, or an option out of range, TypeError on an unknown
        option or one of another type.
        """
        require_mode(render_mode, self.metadata["render_modes"])
        self._arguments = {"task": task, "reward_type": reward_type, "control_type": control_type, **options}
        self.render_mode = render_mode
        self._page = Page()
        self._turn = Turn()
        self.control_type = control_type
        self._batch = spaces.make_batch(task, reward_type, control_type, 1, 1, options)
        self._cameras = EnvCameras(self._batch, None if render_mode == "human" else render_mode, options, 1)
        self.observation_space = spaces.observation_space(self._batch.spec, self._cameras.spaces())
        self.action_space = spaces.action_space(self._batch.spec)

    def __repr__(self) -> str:
        given = self._arguments
        return f"<ArmEnv {given['task']}: {given['reward_type']} reward, control {given['control_type']}>"

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts an episode. The same `seed` gives the same goals as in panda-gym; without one the stream goes on.
        Raises ValueError for options: there are none."""
        if options:
            raise ValueError(f"reset(options={options}): there are no options; goals and objects follow from the seed")
        with self._turn:
            super().reset(seed=seed)
            self._batch.reset(seeds=None if seed is None else spaces.as_seeds([seed]))
            observation, info = self._observation(), self._info()
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One step of 0.04 s; Raises ValueError on a wrong shape or a NaN.

        `truncated` is False, as the limit on steps is gymnasium's, unless numbers stopped being finite: then
        info["unstable"] is True, and the world rests where this step began.
        """
        spec = self._batch.spec
        actions = spaces.as_actions(spec, action, (spec.action_dim,))[None]
        with self._turn:
            self._batch.step(actions)
            reward, terminated = float(self._batch.reward[0]), bool(self._batch.terminated[0])
            observation, info = self._observation(), self._info()
        if self.render_mode == "human":
            self.render()
        if info["unstable"]:
            spaces.warn_unstable()
        return observation, reward, terminated, info["unstable"], info

    def render(self) -> NDArray[Any] | None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """What the render mode says: "rgb_array" (height, width, 3) uint8, "depth_array" (height, width) [m]; "human"
        waits for real time, and while the page is paused; without a mode None, and a warning."""
        if self.render_mode == "human":
            self._page.show(self)
            return None
        if self.render_mode is None:
            spaces.warn_modeless("make")
            return None
        with self._turn:
            return self._cameras.render()

    def close(self) -> None:
        """Takes the page away; may be called again."""
        self._page.close()

    def observe(self) -> Observation:
        """What is observed now."""
        with self._turn:
            return self._observation()

    def training_batch(self, num_envs: int, num_threads: int | None = None) -> EnvBatch:
        """`num_envs` new worlds of this environment in C++, for a trainer."""
        own: dict[str, Any] = dict(self._arguments)
        task, reward_type, control_type = (own.pop(key) for key in ("task", "reward_type", "control_type"))
        return spaces.make_batch(task, reward_type, control_type, num_envs, num_threads or 0, own)  # pyright: ignore[reportArgumentType]

    @property
    def env_spec(self) -> EnvSpec:
        """The sizes of observations, goals and actions."""
        return self._batch.spec

    @property
    def dt(self) -> float:
        """What a step takes [s]."""
        return self._batch.spec.dt

    @property
    def bodies(self) -> EnvBodies:
        """What is seen of the world: `bodies.model`, and `bodies.configuration()`, its q, between two steps."""
        return EnvBodies(self._batch)

    def save_state(self) -> bytes:
        """All that a run needs to continue bit for bit: physics, goal and random stream.

        What wraps the environment is not in it: the steps that gymnasium's TimeLimit has counted are those of its own
        `step`. To look ahead, try actions with `env.unwrapped.step`, which it does not count; to come back to an
        episode with its limit, keep `copy.deepcopy(env)`.
        """
        with self._turn:
            return self._batch.snapshot()

    def restore_state(self, state: bytes) -> Observation:
        """Goes back to a saved state and returns what is observed there. Raises ValueError on one of another task."""
        with self._turn:
            self._batch.restore(state)
            return self._observation()

    def compute_reward(self, achieved_goal: ArrayLike, desired_goal: ArrayLike, info: Any = None) -> Any:
        """The task's reward for goals (..., goal_dim): float32, a scalar or of shape (...). `info` is not used."""
        return spaces.compute_reward(self._batch, achieved_goal, desired_goal)

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in vars(self).items() if name not in _MADE_ANEW}
        return {"kept": kept, "state": self.save_state()}

    def __setstate__(self, saved: dict[str, Any]) -> None:
        kept = saved["kept"]
        ArmEnv.__init__(self, render_mode=kept["render_mode"], **kept["_arguments"])
        vars(self).update(kept)
        self._batch.restore(saved["state"])

    def _observation(self) -> Observation:
        observation, achieved, desired = self._batch.observations()
        rows = {"observation": observation[0], "achieved_goal": achieved[0], "desired_goal": desired[0]}
        return rows | {name: picture[0] for name, picture in self._cameras.observe().items()}

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = {
            "is_success": bool(self._batch.is_success[0]),
            "unstable": bool(self._batch.unstable[0]),
        }
        names = self._batch.spec.randomized
        if names:
            info["randomized"] = dict(zip(names, self._batch.randomized[0].tolist(), strict=True))
        return info
