// PickAndPlace: bring a cube to a place on the table or up to 20 cm above it.
#pragma once

#include "manyhands/envs/tasks/push.h"

namespace manyhands {

struct PickAndPlace : PlaceObject {
  static constexpr const char* kName = "PickAndPlace";
  static constexpr bool kHasGripper = true;

  [[nodiscard]] std::array<ObjectSpec, 1> objects() const { return {cube("object")}; }

  /// Three of ten goals lie on the table.
  [[nodiscard]] TaskStart<3, 1> draw(NumpyRandom& random) const {
    Vec3<double> goal = draw_in_box(random, {-0.15, -0.15, 0}, {0.15, 0.15, 0.2});
    if (random.random() < 0.3) goal.z = 0;
    const Vec3<double> object = draw_in_square(random, 0.3);
    return {.goal = {goal.x, goal.y, 0.02 + goal.z}, .objects = {{{object.x, object.y, 0.02}}}};
  }
};

}  // namespace manyhands
