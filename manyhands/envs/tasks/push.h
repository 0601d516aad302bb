// Push: move a cube over the table to a place. The fingers stay closed.
#pragma once

#include "manyhands/envs/tasks/task.h"

namespace manyhands {

/// What tasks have in common in which one object is to come to a place.
struct PlaceObject {
  static constexpr std::size_t kObjects = 1, kGoalSize = 3, kObservationSize = 12;
  static constexpr bool kGoalIsPlaces = true;
  static constexpr int kMaxEpisodeSteps = 50;
  static constexpr double kDistanceThreshold = 0.05;

  [[nodiscard]] Table table() const { return {}; }

  /// The goal of a cube of another size, whose centre rests higher or lower.
  static void resize(TaskStart<3, 1>& start, double size) { start.goal[2] += (size - 1) * 0.02; }

  template <Number T>
  MANYHANDS_INLINE void observe(const std::array<ObjectState<T>, 1>& objects, T* row) const {
    write_object(objects[0], row);
  }

  template <Number T>
  MANYHANDS_INLINE void achieve(const HandState<T>&, const std::array<ObjectState<T>, 1>& objects, T* goal) const {
    write_point(objects[0].p, goal);
  }

  template <Number T>
  MANYHANDS_INLINE T distance(const T* achieved, const T* desired) const {
    return distance_of<3>(achieved, desired);
  }
};

/// A cube of 4 cm and, unless told otherwise, 1 kg.
[[nodiscard]] inline ObjectSpec cube(std::string name, double mass = 1) {
  return {.name = std::move(name), .shape = {.type = ShapeType::kBox, .size = {0.02, 0.02, 0.02}}, .mass = mass};
}

struct Push : PlaceObject {  ///< a cube on the table, to where the goal is
  static constexpr const char* kName = "Push";
  static constexpr bool kHasGripper = false;

  [[nodiscard]] std::array<ObjectSpec, 1> objects() const { return {cube("object")}; }

  [[nodiscard]] TaskStart<3, 1> draw(NumpyRandom& random) const {
    const Vec3<double> goal = draw_in_square(random, 0.3), object = draw_in_square(random, 0.3);
    return {.goal = {goal.x, goal.y, 0.02}, .objects = {{{object.x, object.y, 0.02}}}};
  }
};

}  // namespace manyhands
