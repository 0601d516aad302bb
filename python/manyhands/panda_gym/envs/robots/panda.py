"""The Franka Emika Panda."""

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from manyhands.panda_gym.envs.core import PyBulletRobot
from manyhands.panda_gym.pybullet import PyBullet
from manyhands.rotations import Array

# panda-gym's; the real arm's wrist has 12 N m in both of its last joints, and a finger 20 N.
_FORCES = (87.0, 87.0, 87.0, 87.0, 12.0, 120.0, 120.0, 170.0, 170.0)
_DOWN = (1.0, 0.0, 0.0, 0.0)
_PER_UNIT = 0.05
"""Of an action: metres of the hand, radians of a joint."""
_OPENING_PER_UNIT = 0.2


class Panda(PyBulletRobot):
    """An arm with two fingers, its base at base_position (3) [m].

    Actions in [-1, 1], clipped: a displacement of the hand (3), 5 cm a unit, with `control_type="ee"`; of the joints
    (7), 0.05 rad a unit, with "joints"; then, unless `block_gripper` keeps the fingers closed, a change of the width
    between them, 20 cm a unit. joint_forces: of the motors (9) [N m or N], panda-gym's unless given.
    """

    def __init__(
        self,
        sim: PyBullet,
        block_gripper: bool = False,
        base_position: ArrayLike | None = None,
        control_type: str = "ee",
        *,
        joint_forces: ArrayLike | None = None,
    ) -> None:
        """Raises ValueError on an unknown control_type."""
        if control_type not in ("ee", "joints"):
            raise ValueError(f"control_type is {control_type!r}, expected 'ee' or 'joints'")
        self.block_gripper = block_gripper
        self.control_type = control_type
        self.fingers_indices = np.array([9, 10])
        self.neutral_joint_values = np.array([0.00, 0.41, 0.00, -1.85, 0.00, 2.26, 0.79, 0.00, 0.00])
        self.ee_link = 11
        size = (3 if control_type == "ee" else 7) + (0 if block_gripper else 1)
        super().__init__(
            sim,
            body_name="panda",
            file_name="franka_panda/panda.urdf",
            base_position=np.zeros(3) if base_position is None else base_position,
            action_space=spaces.Box(-1.0, 1.0, shape=(size,), dtype=np.float32),
            joint_indices=np.array([0, 1, 2, 3, 4, 5, 6, 9, 10]),
            joint_forces=np.array(_FORCES if joint_forces is None else joint_forces, np.float64),
        )

    def setup(self) -> None:
        for finger in self.fingers_indices:
            self.sim.set_lateral_friction(self.body_name, finger, lateral_friction=1.0)
            self.sim.set_spinning_friction(self.body_name, finger, spinning_friction=0.001)

    def set_action(self, action: ArrayLike) -> None:
        """Raises ValueError on a wrong shape or a NaN."""
        numbers = np.array(action, np.float64)
        if numbers.shape != self.action_space.shape or np.isnan(numbers).any():
            raise ValueError(f"the action is {action}; expected {self.action_space.shape} numbers")
        numbers = np.clip(numbers, -1.0, 1.0)
        if self.control_type == "ee":
            arm = self.ee_displacement_to_target_arm_angles(numbers[:3])
        else:
            arm = self.arm_joint_ctrl_to_target_arm_angles(numbers[:7])
        width = 0.0 if self.block_gripper else self.get_fingers_width() + _OPENING_PER_UNIT * numbers[-1]
        self.control_joints(target_angles=np.concatenate([arm, [width / 2, width / 2]]))

    def ee_displacement_to_target_arm_angles(self, ee_displacement: NDArray[Any]) -> Array:
        """Joint angles (7) towards the hand's place displaced by units of 5 cm (3), not below z = 0, pointing down."""
        position = self.get_ee_position() + _PER_UNIT * np.asarray(ee_displacement)[:3]
        position[2] = max(position[2], 0.0)
        return self.inverse_kinematics(self.ee_link, position, _DOWN)[:7]

    def arm_joint_ctrl_to_target_arm_angles(self, arm_joint_ctrl: ArrayLike) -> Array:
        """Joint angles (7) of now, displaced by units of 0.05 rad (7)."""
        now = np.array([self.get_joint_angle(joint) for joint in range(7)])
        return now + _PER_UNIT * np.asarray(arm_joint_ctrl)

    def get_obs(self) -> Array:
        """Position and velocity of the hand, and the fingers' width unless they are blocked: (6) or (7)."""
        hand = [self.get_ee_position(), self.get_ee_velocity()]
        return np.concatenate(hand if self.block_gripper else [*hand, [self.get_fingers_width()]])

    def reset(self) -> None:
        self.set_joint_neutral()

    def set_joint_neutral(self) -> None:
        """Teleports to the neutral pose, at rest, fingers closed."""
        self.set_joint_angles(self.neutral_joint_values)

    def get_fingers_width(self) -> float:
        """Between the fingers [m]: 0 to 0.08."""
        return sum(self.get_joint_angle(finger) for finger in self.fingers_indices)

    def get_ee_position(self) -> Array:
        """Of the point between the finger tips (3) [m]."""
        return self.get_link_position(self.ee_link)

    def get_ee_velocity(self) -> Array:
        """Of the point between the finger tips (3) [m/s]."""
        return self.get_link_velocity(self.ee_link)

    def get_ee_orientation(self) -> Array:
        """Quaternion (4) of the hand."""
        return self.sim.get_link_orientation(self.body_name, self.ee_link)
