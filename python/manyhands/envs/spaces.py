"""Spaces, actions and rewards as the single and the vector environment share them."""

import warnings
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from manyhands._core.envs import EnvBatch, EnvSpec, make_env_batch
from manyhands._core.render import Camera, Look
from manyhands.arguments import whole_number
from manyhands.env_names import env_id
from manyhands.envs.options import require_options
from manyhands.envs.parts import ArmSpec, Obstacle, as_core

Observation: TypeAlias = dict[str, NDArray[Any]]
RewardType: TypeAlias = Literal["sparse", "dense"]
Randomize: TypeAlias = Mapping[str, float | tuple[float, float] | tuple[float, float, str]]
ControlType: TypeAlias = Literal["ee", "joints", "ee_pose", "joint_velocity", "joint_torque", "impedance"]


class EnvOptions(TypedDict, total=False):
    """How the physics of an environment runs, when an episode ends well, and what the scene is made of."""

    n_substeps: int  # physics steps of one environment step: 20
    time_step: float  # of the physics [s]: 0.002
    terminate_on_success: bool  # True
    distance_threshold: float  # success is nearer than this; 0: what the task says
    randomize: Randomize | None  # what differs from episode to episode: docs/randomization.md
    object_shape: str  # "box", "cylinder", "sphere" or "capsule" in place of what the task says
    robot: str | ArmSpec | None  # "panda"; "arm6", and arms of manyhands.robots, as "six_axis+two_finger"
    obstacles: Sequence[Obstacle] | None  # none
    stiffness: tuple[float, float]  # of control_type="impedance": 1000 N/m, 50 N m/rad
    damping: tuple[float, float]  # of the same: 100 N s/m, 2 N m s/rad
    render_width: int  # of `render` [pixels]: 720
    render_height: int  # 480
    render_target_position: ArrayLike | None  # what it looks at (3) [m]: the middle of the table
    render_distance: float  # from there [m]: 1.4
    render_yaw: float  # [degrees]: 45
    render_pitch: float  # [degrees]: -30, down
    render_roll: float  # [degrees]: 0
    render_floor: ArrayLike | None  # red, green and blue of the floor there (3), 0 to 1: its own
    cameras: Mapping[str, "CameraOptions | Camera"] | None  # pictures in the observation: docs/cameras.md


class CameraOptions(TypedDict, total=False):
    """A camera whose pictures are observed."""

    width: int  # [pixels]: 84
    height: int  # 84
    fov_y: float  # from top to bottom [rad]
    eye: ArrayLike  # where it is (3) [m], in the world or in `frame`
    target: ArrayLike  # what it looks at (3) [m]
    up: ArrayLike  # what points to the upper edge (3)
    frame: str  # a link that it is mounted on; "": the world
    depth: bool  # observe depth [m], too
    segmentation: bool  # and the links' numbers
    look: Look  # light and background
    vary: "Mapping[str, Any]"  # what differs from episode to episode, and how much: docs/cameras.md


_CONVERTED = {"randomize", "robot", "obstacles", "cameras"}  # `cameras` elsewhere, with what begins with render_
RENDER_FPS = 25  # one frame per environment step of 0.04 s


def make_batch(
    task: str, reward_type: str, control_type: str, num_envs: int, num_threads: int, options: EnvOptions
) -> EnvBatch:
    """The batch of a variant. Raises ValueError on an unknown task or type, or an option out of range, TypeError on
    an unknown option or one of another type."""
    require_options(options, EnvOptions.__annotations__)
    randomize = options.get("randomize")
    if randomize is not None and not isinstance(randomize, Mapping):
        raise ValueError(f"randomize is {randomize!r}, expected a dict of names and ranges")
    others: Any = {key: value for key, value in options.items() if key not in _CONVERTED and key[:7] != "render_"}
    robot, obstacles = as_core(options.get("robot"), options.get("obstacles"))
    return make_env_batch(
        env_id(task, reward_type, control_type),
        num_envs,
        num_threads=num_threads,
        control_type=control_type,
        randomize=[as_range(key, value) for key, value in (randomize or {}).items()],
        robot=robot,
        obstacles=obstacles,
        **others,
    )


def as_range(name: str, value: Any) -> tuple[str, float, float, bool]:
    """(name, low, high, logarithmic) of x, (low, high) or (low, high, "log"). Raises ValueError on anything else,
    TypeError on a name that is none."""
    if not isinstance(name, str):
        raise TypeError(f"randomize: {name!r} is no name; docs/randomization.md lists them, for example 'object_mass'")
    parts: list[Any] = list(value) if isinstance(value, Sequence) and len(value) > 1 else [value, value]
    low, high, *law = parts
    numbers = all(isinstance(number, int | float | np.integer | np.floating) for number in (low, high))
    if not numbers:
        raise ValueError(f"randomize: {name!r} is {value!r}, expected numbers: x, (low, high) or (low, high, 'log')")
    if law not in ([], ["log"]):
        raise ValueError(f"randomize: {name!r} is {value!r}, expected a number, (low, high) or (low, high, 'log')")
    return name, float(low), float(high), bool(law)


def observation_space(spec: EnvSpec, pictures: Mapping[str, spaces.Space[Any]]) -> spaces.Space[Any]:
    """observation, achieved_goal and desired_goal, each a float32 Box(-10, 10), and the spaces of `pictures`."""

    def box(size: int) -> spaces.Box:
        return spaces.Box(-10.0, 10.0, (size,), np.float32)

    rows = {
        "observation": box(spec.observation_dim),
        "achieved_goal": box(spec.goal_dim),
        "desired_goal": box(spec.goal_dim),
    }
    return spaces.Dict(OrderedDict({**rows, **pictures}))  # in this order, which wrappers that flatten keep


def action_space(spec: EnvSpec) -> spaces.Space[Any]:
    """Box(-1, 1, (action_dim,), float32)."""
    return spaces.Box(-1.0, 1.0, (spec.action_dim,), np.float32)


def as_actions(spec: EnvSpec, action: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """`action` as float32 of the given shape. Raises ValueError if it has another, or holds what is no real number.

    Finite numbers beyond float32 are clipped to [-1, 1] here; the batch clips the others, and refuses NaN and infinity.
    """
    expected = f"{spec.id}: the action is no array of numbers of shape {shape}"
    try:
        array = np.asarray(action)
        if array.dtype.kind not in "biufO":
            raise TypeError(f"it holds {array.dtype}")
        if array.dtype != np.float32:
            wide = array.astype(np.float64)
            array = np.where(np.isinf(wide), wide, wide.clip(-1, 1)).astype(np.float32)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{expected}: {error}") from error
    if array.shape != shape:
        raise ValueError(f"{spec.id}: the action has shape {array.shape}, expected {shape}")
    return array


def as_seeds(seeds: Sequence[int]) -> NDArray[np.uint64]:
    """Seeds as the batch takes them. Raises ValueError unless each lies in [0, 2**64)."""
    for seed in seeds:
        whole_number("seed", seed, 0, 2**64 - 1)
    return np.array(seeds, np.uint64)


def warn_modeless(maker: str) -> None:
    """What Gymnasium's environments say to `render` without a render mode; `maker`: "make" or "make_vec"."""
    gymnasium.logger.warn(
        "render was called without a render mode; give one when the environment is made, "
        f'e.g. gymnasium.{maker}(..., render_mode="rgb_array")'
    )


def warn_unstable() -> None:
    """Python shows it once, unless told otherwise."""
    warnings.warn(
        "the numbers of a world stopped being finite; its episode is truncated and its info has unstable=True. "
        "A shorter time_step or gentler actions help.",
        RuntimeWarning,
        stacklevel=3,
    )


def compute_reward(batch: EnvBatch, achieved_goal: ArrayLike, desired_goal: ArrayLike) -> Any:
    """The reward of goals (..., goal_dim): float32, a scalar or of shape (...)."""
    achieved, desired = np.asarray(achieved_goal, np.float32), np.asarray(desired_goal, np.float32)
    goal_dim = batch.spec.goal_dim
    if achieved.shape != desired.shape or achieved.shape[-1:] != (goal_dim,):
        raise ValueError(
            f"{batch.spec.id}: achieved_goal has shape {achieved.shape} and desired_goal {desired.shape}, "
            f"expected (..., {goal_dim}) both"
        )
    reward = batch.compute_reward(achieved.reshape(-1, goal_dim), desired.reshape(-1, goal_dim))
    return reward.reshape(achieved.shape[:-1])[()]
