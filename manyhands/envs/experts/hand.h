// What all policies share: reading a row, and aiming the hand.
#pragma once

#include <algorithm>
#include <cmath>

#include "manyhands/math/vec3.h"

namespace manyhands::experts {

using Point = Vec3<float>;

/// Three numbers of a row.
[[nodiscard]] inline Point point(const float* row) { return {row[0], row[1], row[2]}; }

/// Seen from above [m].
[[nodiscard]] inline float flat_distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// An action of end-effector control: a displacement in units of 5 cm, and for tasks with a gripper its opening in
/// units of 20 cm. Components beyond [-1, 1] are clipped.
struct HandAction {
  Point move;
  float grip = -1;
};

/// The displacement that would take the hand to the target in one step. Far from the base, where the arm is nearly
/// stretched and panda-gym's inverse kinematics falls short, x is asked for more.
[[nodiscard]] inline Point aim(const Point& hand, const Point& target) {
  constexpr float kPerMetre = 20, kFar = 0.12f, kFarGain = 1.5f;
  Point move = kPerMetre * (target - hand);
  if (hand.x > kFar) move.x *= kFarGain;
  return move;
}

}  // namespace manyhands::experts
