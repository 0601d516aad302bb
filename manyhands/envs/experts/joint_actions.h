// What experts that drive joints have in common: a script's action of the hand becomes one of the joints.
#pragma once

#include <algorithm>
#include <cmath>

#include "manyhands/envs/arm.h"
#include "manyhands/envs/experts/expert.h"

namespace manyhands::experts {

inline constexpr std::size_t kHandMove = 3;  ///< numbers of a hand's action before the gripper's

/// Numbers of an action by the joints: the arm's, and the gripper's where the hand's expert has it.
[[nodiscard]] inline int joint_action_dim(const Arm& arm, const Expert& hand_expert) {
  return static_cast<int>(arm.joints.size()) + hand_expert.action_dim() - static_cast<int>(kHandMove);
}

/// From posture `from` (nq) to `to`; where that is farther than an action reaches, as far as it goes in the same
/// direction.
inline void write_joint_action(const Arm& arm, const float* from, const float* to, float* action) {
  constexpr float kUnit = 0.05f;  // of an action under control of the joints [rad]
  float most = 1;
  for (std::size_t k = 0; k < arm.joints.size(); ++k) {
    action[k] = (to[arm.joints[k]] - from[arm.joints[k]]) / kUnit;
    most = std::max(most, std::abs(action[k]));
  }
  for (std::size_t k = 0; k < arm.joints.size(); ++k) action[k] /= most;
}

}  // namespace manyhands::experts
