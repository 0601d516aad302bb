// What makes a task, and how a goal is judged.
#pragma once

#include <array>
#include <concepts>

#include "manyhands/envs/object.h"
#include "manyhands/envs/scene.h"
#include "manyhands/math/numpy_random.h"

namespace manyhands {

enum class Reward {
  kSparse,  ///< -1 until the goal is reached, then 0
  kDense,   ///< minus the distance
};

struct Goals {  ///< what is a success, and what is paid for it
  Reward reward = Reward::kSparse;
  double distance_threshold = 0.05;  ///< success is nearer than this, in the task's measure of distance
};

template <Number T>
struct Outcome {  ///< of one step, in each lane
  T reward;
  mask_t<T> success;
};

/// Reward and success at a distance from the goal. Exactly at the threshold the reward is 0 and success is false, as in
/// panda-gym.
template <Number T>
MANYHANDS_INLINE Outcome<T> judge(const Goals& goals, T distance) {
  using R = real_t<T>;
  const T threshold(static_cast<R>(goals.distance_threshold));
  const T sparse = select(distance <= threshold, T(R(0)), T(R(-1)));
  return {goals.reward == Reward::kSparse ? sparse : -distance, distance < threshold};
}

/// Where an episode begins: drawn in double, in panda-gym's order.
template <std::size_t kGoalSize, std::size_t kObjects>
struct TaskStart {
  std::array<double, kGoalSize> goal{};
  std::array<Vec3<double>, kObjects> objects{};  ///< their centres; none is turned
};

/// What a task must have; see push.h for a small one. Sizes are numbers of floats; `Objects` are ObjectState<T>. It may
/// have `kShapes`, where its objects cannot have just any shape, resize(start, size), where goals depend on the size of
/// objects, and `kGoalIsPlaces`, where a goal is a place for each object, or for the hand: no obstacle may be there.
template <class Task>
concept TaskLike = requires(const Task& task, NumpyRandom& random, const HandState<float>& hand,
                            const std::array<ObjectState<float>, Task::kObjects>& objects, float* row) {
  { Task::kHasGripper } -> std::convertible_to<bool>;
  { Task::kObservationSize } -> std::convertible_to<std::size_t>;  ///< beside the hand's
  { Task::kMaxEpisodeSteps } -> std::convertible_to<int>;
  { Task::kDistanceThreshold } -> std::convertible_to<double>;
  { task.table() } -> std::same_as<Table>;
  { task.objects() } -> std::same_as<std::array<ObjectSpec, Task::kObjects>>;
  { task.draw(random) } -> std::same_as<TaskStart<Task::kGoalSize, Task::kObjects>>;
  task.observe(objects, row);
  task.achieve(hand, objects, row);
  { task.distance(row, row) } -> std::same_as<float>;
};

/// Three draws, one for each axis, even where its range is a point: as numpy draws a vector.
[[nodiscard]] inline Vec3<double> draw_in_box(NumpyRandom& random, const Vec3<double>& low, const Vec3<double>& high) {
  const double x = random.uniform(low.x, high.x), y = random.uniform(low.y, high.y), z = random.uniform(low.z, high.z);
  return {x, y, z};
}

/// A point of a square about the origin, of side `range`.
[[nodiscard]] inline Vec3<double> draw_in_square(NumpyRandom& random, double range) {
  return draw_in_box(random, {-range / 2, -range / 2, 0}, {range / 2, range / 2, 0});
}

/// Writes x, y, z from `row` on.
template <Number T>
MANYHANDS_INLINE void write_point(const Vec3<T>& p, T* row) {
  row[0] = p.x;
  row[1] = p.y;
  row[2] = p.z;
}

/// The Euclidean distance of two rows.
template <std::size_t kSize, Number T>
[[nodiscard]] MANYHANDS_INLINE T distance_of(const T* a, const T* b) {
  T square(real_t<T>(0));
  for (std::size_t i = 0; i < kSize; ++i) square = fma(a[i] - b[i], a[i] - b[i], square);
  return sqrt(square);
}

}  // namespace manyhands
