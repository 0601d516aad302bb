#include "manyhands/envs/control/control.h"

namespace manyhands {

MANYHANDS_CONTROL(, float, float)

int action_size(const Arm& arm) {
  const std::size_t grip = arm.has_gripper ? 1 : 0;
  switch (arm.control) {
    case ArmControl::kEndEffector:
      return static_cast<int>(3 + grip);
    case ArmControl::kEndEffectorPose:
    case ArmControl::kImpedance:
      return static_cast<int>(6 + grip);
    case ArmControl::kJoints:
    case ArmControl::kJointVelocity:
    case ArmControl::kJointTorque:
      break;
  }
  return static_cast<int>(arm.joints.size() + grip);
}

}  // namespace manyhands
