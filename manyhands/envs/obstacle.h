// What stands in the way in a task: a shape that never moves.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands {

/// A box, sphere, cylinder or capsule, fixed in the world. Starts that would put an object or a goal into it are drawn
/// again; those that are clear of it stay what they are without it.
struct Obstacle {
  Shape shape{};
  Transform<double> X_WO = Transform<double>::identity();
  double friction = 0.5;
  std::array<float, 4> rgba{0.6f, 0.6f, 0.6f, 1};
};

}  // namespace manyhands
