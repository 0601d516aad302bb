// Flip: turn a cube to an orientation, wherever it is.
#pragma once

#include "manyhands/envs/tasks/push.h"

namespace manyhands {

struct Flip {
  static constexpr const char* kName = "Flip";
  static constexpr std::size_t kObjects = 1, kGoalSize = 4, kObservationSize = 13;
  static constexpr bool kHasGripper = true;
  static constexpr int kMaxEpisodeSteps = 50;
  static constexpr double kDistanceThreshold = 0.2;

  static constexpr std::array kShapes{"box"};  ///< that show how they are turned

  [[nodiscard]] Table table() const { return {}; }

  [[nodiscard]] std::array<ObjectSpec, 1> objects() const {
    ObjectSpec die = cube("object");
    die.rgba = {1, 1, 1, 1};
    return {die};
  }

  /// The goal is uniform among all rotations.
  [[nodiscard]] TaskStart<4, 1> draw(NumpyRandom& random) const {
    std::array<double, 4> goal{};
    double square = 0;
    for (double& x : goal) {
      x = random.standard_normal();
      square += x * x;
    }
    for (double& x : goal) x /= std::sqrt(square);
    const Vec3<double> object = draw_in_square(random, 0.3);
    return {.goal = goal, .objects = {{{object.x, object.y, 0.02}}}};
  }

  template <Number T>
  MANYHANDS_INLINE void observe(const std::array<ObjectState<T>, 1>& objects, T* row) const {
    const ObjectState<T>& die = objects[0];
    write_point(die.p, row);
    write_rotation(die.r, row + 3);
    write_point(die.v, row + 7);
    write_point(die.w, row + 10);
  }

  template <Number T>
  MANYHANDS_INLINE void achieve(const HandState<T>&, const std::array<ObjectState<T>, 1>& objects, T* goal) const {
    write_rotation(objects[0].r, goal);
  }

  /// 1 - <a, b>^2 = sin^2 of half the angle between the two.
  template <Number T>
  MANYHANDS_INLINE T distance(const T* achieved, const T* desired) const {
    T along(real_t<T>(0));
    for (std::size_t i = 0; i < kGoalSize; ++i) along = fma(achieved[i], desired[i], along);
    return fma(-along, along, T(real_t<T>(1)));
  }

 private:
  template <Number T>
  static MANYHANDS_INLINE void write_rotation(const Quat<T>& r, T* row) {
    row[0] = r.x;
    row[1] = r.y;
    row[2] = r.z;
    row[3] = r.w;
  }
};

}  // namespace manyhands
