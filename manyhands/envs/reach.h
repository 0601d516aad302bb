// Reach: bring the hand to a point. Goals lie in a box of 0.3 m above the table, centred on the world's origin.
#pragma once

#include "manyhands/math/numpy_random.h"
#include "manyhands/math/vec3.h"

namespace manyhands {

enum class Reward {
  kSparse,  ///< -1 until the goal is reached, then 0
  kDense,   ///< minus the distance [m]
};

struct ReachTask {
  Reward reward = Reward::kSparse;
  double distance_threshold = 0.05;  ///< [m]

  static constexpr int kGoalSize = 3;
};

/// A goal, drawn as panda-gym draws it: three uniform numbers, x first.
[[nodiscard]] inline Vec3<float> sample_reach_goal(NumpyRandom& random) {
  const double x = random.uniform(-0.15, 0.15), y = random.uniform(-0.15, 0.15), z = random.uniform(0.0, 0.3);
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

template <Number T>
struct Outcome {
  T reward;
  mask_t<T> success;
};

/// Reward and success of an achieved goal. Exactly at the threshold the reward is 0 and success is false, as in
/// panda-gym.
template <Number T>
MANYHANDS_INLINE Outcome<T> judge(const ReachTask& task, const Vec3<T>& achieved, const Vec3<T>& desired) {
  using R = real_t<T>;
  const T distance = norm(achieved - desired), threshold(static_cast<R>(task.distance_threshold));
  const T sparse = select(distance <= threshold, T(R(0)), T(R(-1)));
  return {task.reward == Reward::kSparse ? sparse : -distance, distance < threshold};
}

}  // namespace manyhands
