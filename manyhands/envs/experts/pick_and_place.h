// PickAndPlace: take the cube from above and carry it straight to the goal.
#pragma once

#include "manyhands/envs/experts/grasp.h"

namespace manyhands::experts {

struct PickAndPlace {
  static constexpr const char* kTask = "PickAndPlace";
  static constexpr std::size_t kObservation = 19, kGoal = 3, kActions = 4;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), cube = point(row + 7);
    return holds(hand, row[6], cube) ? carry(hand, cube, point(goal), {}) : fetch(hand, cube, {});
  }
};

}  // namespace manyhands::experts
