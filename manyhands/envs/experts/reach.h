// Reach: straight to the goal.
#pragma once

#include "manyhands/envs/experts/hand.h"

namespace manyhands::experts {

struct Reach {
  static constexpr const char* kTask = "Reach";
  static constexpr std::size_t kObservation = 6, kGoal = 3, kActions = 3;

  [[nodiscard]] HandAction act(const float* row, const float* goal) { return {aim(point(row), point(goal))}; }
};

}  // namespace manyhands::experts
