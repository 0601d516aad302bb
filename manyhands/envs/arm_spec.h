// Which arm stands in a task, and what an action means to it.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "manyhands/control/impedance.h"

namespace manyhands {

class Model;

/// What an action (each number in [-1, 1]) does to the arm within one environment step. The gripper's number comes
/// after these; it opens the fingers by 20 cm per unit. See control/*.h.
enum class ArmControl {
  kEndEffector,      ///< (3) displacement of the hand, 5 cm per unit; the hand points straight down
  kJoints,           ///< (joints) displacement of the joints, 0.05 rad or m per unit
  kEndEffectorPose,  ///< (6) displacement of the hand, and its turn from pointing down, 90 degrees per unit
  kJointVelocity,    ///< (joints) their velocity, 1 rad/s or m/s per unit
  kJointTorque,      ///< (joints) force beyond what holds the arm, a tenth of the motor's largest per unit
  kImpedance,        ///< (6) as kEndEffectorPose, of the pose to which a spring pulls the hand
};

/// By the names that users give them: "ee", "joints", "ee_pose", "joint_velocity", "joint_torque", "impedance".
inline constexpr std::array<std::pair<const char*, ArmControl>, 6> kArmControls{{
    {"ee", ArmControl::kEndEffector},
    {"joints", ArmControl::kJoints},
    {"ee_pose", ArmControl::kEndEffectorPose},
    {"joint_velocity", ArmControl::kJointVelocity},
    {"joint_torque", ArmControl::kJointTorque},
    {"impedance", ArmControl::kImpedance},
}};

/// Throws std::invalid_argument, which lists the names, on an unknown one.
[[nodiscard]] ArmControl arm_control(const std::string& name);

/// What tasks must know of an arm besides its URDF. Its joints are named in the order of actions, fingers last. Joints
/// that mimic others follow them. The first link is the base, which stands fixed.
struct ArmSpec {
  std::filesystem::path urdf;
  std::shared_ptr<const Model> model{};                    ///< in place of the file, if there is one
  Transform<double> X_WA = Transform<double>::identity();  ///< of its base
  std::vector<std::string> joints, fingers;
  /// For each finger: its q where the hand is closed, and by how much the hand opens per unit [m/rad or 1], not 0.
  /// Empty: 0, and 1 for fingers that slide.
  std::vector<double> closed{}, opening{};
  std::string hand;               ///< the frame or link between the finger tips, z away from the hand
  std::vector<double> neutral;    ///< where every episode starts [rad or m]
  std::vector<double> max_force;  ///< of the motors [N m or N]
  bool meshes = true;             ///< whether the file's collision shapes that need a mesh count
};

/// The arms that ship with the library: "panda" and "arm6". Throws std::invalid_argument, which lists them, on others.
[[nodiscard]] ArmSpec arm_spec(const std::string& name);

}  // namespace manyhands
