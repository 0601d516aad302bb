// What stands in the way in a task: a shape that never moves.
#pragma once

#include "manyhands/model/description.h"

namespace manyhands {

/// A box, sphere, cylinder or capsule, fixed in the world. Where episodes start does not depend on it: keep it clear of
/// the square of 0.3 m about the origin in which objects start, or they may start inside of it and are pushed out.
struct Obstacle {
  Shape shape{};
  Transform<double> X_WO = Transform<double>::identity();
  double friction = 0.5;
  std::array<float, 4> rgba{0.6f, 0.6f, 0.6f, 1};
};

}  // namespace manyhands
