"""What an environment may be made with: another arm, obstacles."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from manyhands._core import envs as core


@dataclass(frozen=True, kw_only=True)
class ArmSpec:
    """An arm with a gripper from a URDF file, for `gymnasium.make("PandaPush-v3", robot=ArmSpec(...))`.

    The base stands at a pose in the world, where the table's top is z = 0. Movable joints that are not named swing
    freely, except for those that follow others by `<mimic>`. What does not fit raises ValueError when the environment
    is made.
    """

    urdf: str | Path
    joints: Sequence[str]  # of the arm, in the order of actions: revolute, continuous or prismatic
    fingers: Sequence[str] = ()  # prismatic; the hand opens by the sum of their positions
    hand: str  # the link between the finger tips; its z axis points away from the hand
    neutral: Sequence[float]  # where episodes start: of the joints, then of the fingers [rad or m]
    max_force: Sequence[float]  # of the motors: of the joints, then of the fingers [N m or N]
    position: Sequence[float] = (-0.6, 0.0, 0.0)  # of the base [m]
    quaternion: Sequence[float] = (0.0, 0.0, 0.0, 1.0)  # of the base, xyzw
    meshes: bool = True  # whether collision shapes from mesh files count, as their convex hulls


@dataclass(frozen=True)
class Obstacle:
    """A shape that never moves, for `gymnasium.make("PandaReach-v3", obstacles=[Obstacle("sphere", 0.05)])`.

    Goals and objects are drawn as without it, and drawn again where they would lie in it. Raises TypeError or
    ValueError if it cannot be, and ValueError, when the environment is made, if it touches the arm in its neutral pose
    or leaves hardly any place for objects or goals.
    """

    shape: str  # "box", "sphere", "cylinder" or "capsule"
    size: float | Sequence[float]  # half extents; radius; radius and half length [m]
    position: Sequence[float] = (0.0, 0.0, 0.0)  # of the centre [m]
    quaternion: Sequence[float] = (0.0, 0.0, 0.0, 1.0)  # xyzw
    friction: float = 0.5

    def __post_init__(self) -> None:
        core.Obstacle(**asdict(self))


def as_core(
    robot: str | ArmSpec | None, obstacles: Sequence[Obstacle] | None
) -> tuple[str | core.ArmSpec, list[core.Obstacle]]:
    """The same for the extension module; None is the Panda, and no obstacle. Raises TypeError on anything else."""
    return _as_arm(robot), _as_obstacles(obstacles)


def _as_arm(robot: Any) -> str | core.ArmSpec:
    if robot is None:
        return "panda"
    if isinstance(robot, str) and Path(robot).suffix not in (".urdf", ".xml"):
        return robot
    if not isinstance(robot, ArmSpec):
        raise TypeError(
            f"robot is {robot!r}, expected 'panda', 'arm6' or an ArmSpec: a file alone does not say which joints are "
            "the arm's and where its hand is, manyhands.envs.ArmSpec(urdf=..., joints=..., hand=..., ...) does"
        )
    return core.ArmSpec(**asdict(robot))


def _as_obstacles(obstacles: Any) -> list[core.Obstacle]:
    if obstacles is None:
        return []
    if not isinstance(obstacles, Sequence) or isinstance(obstacles, str):
        raise TypeError(f"obstacles is {obstacles!r}, expected a list of manyhands.envs.Obstacle")
    found: list[core.Obstacle] = []
    for number, one in enumerate(obstacles):
        if not isinstance(one, Obstacle):
            raise TypeError(
                f"obstacles[{number}] is {one!r}, expected a manyhands.envs.Obstacle, as Obstacle('sphere', 0.05)"
            )
        found.append(core.Obstacle(**asdict(one)))
    return found
