"""What an environment may be made with: another arm, obstacles."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from manyhands import robots
from manyhands._core import Model
from manyhands._core import envs as core
from manyhands.ik import inverse

_CORNERS = [[x, y, z] for x in (-0.15, 0.15) for y in (-0.15, 0.15) for z in (0.02, 0.22)]  # of where tasks have things
_DOWN = (1.0, 0.0, 0.0, 0.0)  # x ahead, fingers side by side along y


@dataclass(frozen=True, kw_only=True)
class ArmSpec:
    """An arm with a gripper, for `gymnasium.make("PandaPush-v3", robot=ArmSpec(...))`; `ArmSpec.of` describes those
    that ship.

    The base stands at a pose in the world, where the table's top is z = 0. Movable joints that are not named swing
    freely, except for those that follow others by `<mimic>`. What does not fit raises ValueError when the environment
    is made.
    """

    urdf: str | Path | Model  # a file, or a model whose base is fixed
    joints: Sequence[str]  # of the arm, in the order of actions: revolute, continuous or prismatic
    fingers: Sequence[str] = ()
    closed: Sequence[float] = ()  # of each finger, where the hand's width is 0; default: 0 [rad or m]
    opening: Sequence[float] = ()  # of each: the hand's width per unit; default: 1, of fingers that slide [m/rad or 1]
    hand: str  # the link between the finger tips; z points away from the hand, x along the world's x when held down
    neutral: Sequence[float]  # where episodes start: of the joints, then of the fingers [rad or m]
    max_force: Sequence[float]  # of the motors: of the joints, then of the fingers [N m or N]
    position: Sequence[float] = (-0.6, 0.0, 0.0)  # of the base [m]
    quaternion: Sequence[float] = (0.0, 0.0, 0.0, 1.0)  # of the base, xyzw
    meshes: bool = True  # whether a URDF file's collision shapes from meshes count, as their convex hulls

    @classmethod
    def of(
        cls,
        arm: str | Model,
        gripper: str | None = None,
        *,
        flange: str = "",
        position: Sequence[float] | None = None,
        start: Sequence[float] = (0.04, 0.0, 0.2),
        posture: Sequence[float] = (),
    ) -> "ArmSpec":
        """An arm of `manyhands.robots`, or any model of one, with a gripper of `manyhands.robots` on its flange; motors
        as strong as its file says.

        flange: of a model, the link or frame where the gripper goes, z outwards.
        position: of the base (3,) [m]; None: behind the table's middle, at most 0.6 m, where the hand reaches all
        places of the tasks.
        start: where the hand is when episodes begin (3,) [m]; it points down, closed, and its yaw is fixed: x of `hand`
        along the world's x, so that fingers that close along y of it do so along the world's y. It is no choice of this
        function: control of the hand's position holds it so, in every environment.
        posture: of the arm's joints, as it shall bend there, about [rad or m]; default: where the model starts, which
        is home for those that ship.
        Raises ValueError on unknown names, and where the hand cannot be at `start` or, without a position, reach.
        """
        if isinstance(arm, str):
            hand, model = robots.describe(arm), robots.load(arm, gripper=gripper)
            movable = list(hand.home)
        else:
            hand = robots.Description("arm", "", flange=flange)
            movable = [joint.name for joint in arm.joints if joint.nv == 1]
            model = robots.attach(arm, gripper, flange) if gripper else arm
        hand = robots.describe(gripper) if gripper else hand
        prefix = robots.GRIPPER if gripper else ""
        frame = prefix + (hand.tool or hand.flange)
        fingers = {prefix + joint: place for joint, place in hand.closed.items()}
        joints = [joint for joint in movable if joint not in fingers]
        near = model.initial_configuration()
        if len(posture) not in (0, len(joints)):
            raise ValueError(f"posture has {len(posture)} numbers; expected one for each of {', '.join(joints)}")
        for joint, angle in zip(joints, posture, strict=False):
            near[model.joint(joint).iq] = angle
        is_free = position is None
        stands = [(-k / 20, 0.0, 0.0) for k in range(12, 2, -1)] if is_free else [position]
        place, q = _standing(model, frame, near, stands, [start, *_CORNERS] if is_free else [start])
        closed, opening = _fingers(hand) if fingers else ((), ())
        return cls(
            urdf=model,
            joints=joints,
            fingers=list(fingers),
            closed=closed,
            opening=opening,
            hand=frame,
            neutral=[*(float(q[model.joint(joint).iq]) for joint in joints), *fingers.values()],
            max_force=[model.joint(joint).effort for joint in (*joints, *fingers)],
            position=place,
        )


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


def hand_of(robot: str | ArmSpec | None) -> str:
    """The frame between the fingers."""
    described = _described(robot)
    return f"{described}_grasptarget" if isinstance(described, str) else described.hand


def _standing(
    model: Model,
    frame: str,
    near: NDArray[np.float64],
    stands: Sequence[Sequence[float]],
    goals: Sequence[Sequence[float]],
) -> tuple[Sequence[float], NDArray[np.float64]]:
    """The first place of the base from which the hand, pointing down, reaches all goals, and q (nq) at the first."""
    for place in stands:
        found = inverse(model, frame, position=np.subtract(goals, place), quaternion=_DOWN, start=near, posture=near)
        if found.success.all():
            return place, found.q[0]
    raise ValueError(
        f"{model.name} stands at {stands[0] if len(stands) == 1 else 'x = -0.6 m, or nearer'} and cannot bring {frame} "
        f"to {goals[0] if len(goals) == 1 else 'all of the table'}, pointing down; give another position"
    )


def _fingers(hand: robots.Description) -> tuple[list[float], list[float]]:
    """`closed` and `opening` of the joint that drives a gripper, as if it opened evenly."""
    ((joint, closed),) = hand.closed.items()
    narrow, wide = hand.width
    opening = (wide - narrow) / (hand.home[joint] - closed)
    return [closed - narrow / opening], [opening]


def _described(robot: Any) -> Any:
    """ "panda" and "arm6" as they are, other arms by name as what they are."""
    if robot is None:
        return "panda"
    if not isinstance(robot, str) or robot in ("panda", "arm6") or Path(robot).suffix in (".urdf", ".xml"):
        return robot
    arm, gripper = robots.split(robot)
    if arm not in robots.names("arm"):
        raise ValueError(
            f"robot is {robot!r}, expected 'panda', 'arm6' or an ArmSpec of your own, or one of "
            f"{', '.join(robots.names('arm'))}, with a gripper as 'six_axis+two_finger'"
        )
    return ArmSpec.of(arm, gripper)


def _as_arm(robot: Any) -> str | core.ArmSpec:
    robot = _described(robot)
    if robot in ("panda", "arm6"):
        return robot
    if not isinstance(robot, ArmSpec):
        raise TypeError(
            f"robot is {robot!r}, expected 'panda', 'arm6' or an ArmSpec: a file alone does not say which joints are "
            "the arm's and where its hand is, manyhands.envs.ArmSpec(urdf=..., joints=..., hand=..., ...) does"
        )
    return core.ArmSpec(**vars(robot))


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
