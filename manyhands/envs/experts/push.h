// Push: press on the cube's top with the closed finger tips and draw it over the table. The finger holds the cube with
// more friction than the table does as soon as it presses with more than the cube's weight, so the cube goes wherever
// the hand goes: also towards the base from places that the hand could not get behind. A ball rolls away under the
// finger: it is pushed from behind where the hand can get there.
#pragma once

#include "manyhands/envs/experts/hand.h"

namespace manyhands::experts {

struct Push {
  static constexpr const char* kTask = "Push";
  static constexpr std::size_t kObservation = 18, kGoal = 3, kActions = 3;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), cube = point(row + 6);
    const float off = flat_distance(hand, cube);
    if (row[3] == 0 && row[4] == 0 && row[5] == 0) rolls_ = false;  // an episode begins
    rolls_ = rolls_ || is_rolled(cube, row[10]);
    const Point from_goal = cube - point(goal);
    const Point back = (1 / std::max(std::hypot(from_goal.x, from_goal.y), 1e-6f)) * Point{from_goal.x, from_goal.y, 0};
    if (rolls_ && cube.x + kBehind * back.x < kReach) return {roll(hand, cube, point(row + 12), back)};
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

  /// A cube that is tilted so far stands on an edge, higher than it lies.
  static bool is_rolled(const Point& cube, float pitch) {
    return std::abs(pitch) > 0.2f && std::abs(pitch) < 1.2f && cube.z < 0.0215f;
  }

  /// One step of pushing a ball from behind: the hand comes down on the line from the goal through the ball, and goes
  /// on along it. `back` is the unit vector from the goal.
  static Point roll(const Point& hand, const Point& ball, const Point& velocity, const Point& back) {
    constexpr float kLow = 0.025f, kHigh = 0.06f, kLead = 0.06f;
    const Point off{hand.x - ball.x, hand.y - ball.y, 0};
    const float behind = dot(off, back);
    const Point aside = off - behind * back;
    if (hand.z < kLow + 0.015f && behind > 0.015f && norm(aside) < 0.012f)
      return Point{0, 0, 20 * (kLow - hand.z)} - 20 * aside - 0.3f * back;
    const Point start = ball + kLead * velocity + kBehind * back;
    const float away = flat_distance(hand, start);
    const bool is_low = hand.z < 0.05f, down = away < 0.02f || (is_low && away < 0.03f);
    if (!down && is_low) return {0, 0, 20 * (kHigh - hand.z)};
    return aim(hand, {start.x, start.y, down ? kLow : kHigh});
  }

  static constexpr float kBehind = 0.045f, kReach = 0.16f;
  bool rolls_ = false;
};

}  // namespace manyhands::experts
