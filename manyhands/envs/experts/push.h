// Push: press on the cube's top with the closed finger tips and draw it over the table. The finger holds the cube with
// more friction than the table does as soon as it presses with more than the cube's weight, so the cube goes wherever
// the hand goes: also towards the base from places that the hand could not get behind.
#pragma once

#include "manyhands/envs/experts/hand.h"

namespace manyhands::experts {

struct Push {
  static constexpr const char* kTask = "Push";
  static constexpr std::size_t kObservation = 18, kGoal = 3, kActions = 3;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), cube = point(row + 6);
    const float off = flat_distance(hand, cube);
    return {off < kOnTop && hand.z < kTouching ? draw(hand, cube, point(goal)) : approach(hand, cube, off)};
  }

 private:
  static constexpr float kOnTop = 0.015f, kTouching = 0.052f;
  static constexpr float kPress = 0.035f;  ///< aimed at below the top: presses the cube

  static Point draw(const Point& hand, const Point& cube, const Point& goal) {
    const Point way = goal - cube;
    const float distance = std::max(std::hypot(way.x, way.y), 1e-6f);
    const float speed = std::min(10 * distance + 0.1f, 0.6f) / distance;
    return {speed * way.x, speed * way.y, aim(hand, {hand.x, hand.y, kPress}).z};
  }

  /// Comes down on a slope, slowly at the end, so that nothing hits the cube from the side.
  static Point approach(const Point& hand, const Point& cube, float off) {
    const float height = off < 0.01f ? kPress : 0.07f + 2 * std::max(off - 0.03f, 0.0f);
    Point move = aim(hand, {cube.x, cube.y, height});
    if (hand.x > 0.09f) move.x = std::min(move.x, 0.4f);
    if (hand.z < 0.12f) move.z = std::max(move.z, -0.5f);
    return move;
  }
};

}  // namespace manyhands::experts
