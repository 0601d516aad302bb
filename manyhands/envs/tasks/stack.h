// Stack: bring a cube of 2 kg to a place, and a second one on top of it.
#pragma once

#include "manyhands/envs/tasks/push.h"

namespace manyhands {

struct Stack {
  static constexpr const char* kName = "Stack";
  static constexpr std::size_t kObjects = 2, kGoalSize = 6, kObservationSize = 24;
  static constexpr bool kHasGripper = true, kGoalIsPlaces = true;
  static constexpr int kMaxEpisodeSteps = 100;
  static constexpr double kDistanceThreshold = 0.1;

  static constexpr std::array kShapes{"box", "cylinder"};  ///< that can be stacked

  [[nodiscard]] Table table() const { return {}; }

  [[nodiscard]] std::array<ObjectSpec, 2> objects() const {
    std::array<ObjectSpec, 2> cubes{cube("object1", 2), cube("object2")};
    cubes[0].rgba = {0.1f, 0.1f, 0.9f, 1};
    return cubes;
  }

  /// The second cube starts 4 cm above the table, and may fall onto the first.
  [[nodiscard]] TaskStart<6, 2> draw(NumpyRandom& random) const {
    const Vec3<double> goal = draw_in_square(random, 0.3), a = draw_in_square(random, 0.3),
                       b = draw_in_square(random, 0.3);
    return {.goal = {goal.x, goal.y, 0.02, goal.x, goal.y, 0.06}, .objects = {{{a.x, a.y, 0.02}, {b.x, b.y, 0.06}}}};
  }

  static void resize(TaskStart<6, 2>& start, double size) {
    for (const std::size_t z : {2U, 5U}) start.goal[z] *= size;
  }

  template <Number T>
  MANYHANDS_INLINE void observe(const std::array<ObjectState<T>, 2>& objects, T* row) const {
    write_object(objects[0], row);
    write_object(objects[1], row + 12);
  }

  template <Number T>
  MANYHANDS_INLINE void achieve(const HandState<T>&, const std::array<ObjectState<T>, 2>& objects, T* goal) const {
    write_point(objects[0].p, goal);
    write_point(objects[1].p, goal + 3);
  }

  template <Number T>
  MANYHANDS_INLINE T distance(const T* achieved, const T* desired) const {
    return distance_of<6>(achieved, desired);
  }
};

}  // namespace manyhands
