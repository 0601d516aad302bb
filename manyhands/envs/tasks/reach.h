// Reach: bring the hand to a point. Goals lie in a box of 0.3 m above the table, centred on the world's origin.
#pragma once

#include "manyhands/envs/tasks/task.h"

namespace manyhands {

struct Reach {
  static constexpr const char* kName = "Reach";
  static constexpr std::size_t kObjects = 0, kGoalSize = 3, kObservationSize = 0;
  static constexpr bool kHasGripper = false, kGoalIsPlaces = true;
  static constexpr int kMaxEpisodeSteps = 50;
  static constexpr double kDistanceThreshold = 0.05;

  [[nodiscard]] Table table() const { return {}; }
  [[nodiscard]] std::array<ObjectSpec, 0> objects() const { return {}; }

  [[nodiscard]] TaskStart<3, 0> draw(NumpyRandom& random) const {
    const Vec3<double> p = draw_in_box(random, {-0.15, -0.15, 0}, {0.15, 0.15, 0.3});
    return {.goal = {p.x, p.y, p.z}};
  }

  template <Number T>
  MANYHANDS_INLINE void observe(const std::array<ObjectState<T>, 0>&, T*) const {}

  template <Number T>
  MANYHANDS_INLINE void achieve(const HandState<T>& hand, const std::array<ObjectState<T>, 0>&, T* goal) const {
    write_point(hand.p, goal);
  }

  template <Number T>
  MANYHANDS_INLINE T distance(const T* achieved, const T* desired) const {
    return distance_of<3>(achieved, desired);
  }
};

}  // namespace manyhands
