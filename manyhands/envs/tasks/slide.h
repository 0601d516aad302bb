// Slide: hit a puck so that it comes to rest at a place beyond the arm's reach.
#pragma once

#include "manyhands/envs/tasks/push.h"

namespace manyhands {

/// The puck drops 15 mm at every start and its goals lie as high above where it rests, as in panda-gym.
struct Slide : PlaceObject {
  static constexpr const char* kName = "Slide";
  static constexpr bool kHasGripper = false;

  [[nodiscard]] Table table() const { return {.length = 1.4, .x_offset = -0.1}; }

  [[nodiscard]] std::array<ObjectSpec, 1> objects() const {
    const Shape puck{.type = ShapeType::kCylinder, .size = {0.03, 0.015, 0}};
    return {ObjectSpec{.name = "object", .shape = puck, .friction = 0.04}};
  }

  static void resize(TaskStart<3, 1>& start, double size) { start.goal[2] += (size - 1) * 0.015; }

  [[nodiscard]] TaskStart<3, 1> draw(NumpyRandom& random) const {
    const Vec3<double> goal = draw_in_box(random, {0.25, -0.15, 0}, {0.55, 0.15, 0});
    const Vec3<double> object = draw_in_square(random, 0.3);
    return {.goal = {goal.x, goal.y, 0.03}, .objects = {{{object.x, object.y, 0.03}}}};
  }
};

}  // namespace manyhands
