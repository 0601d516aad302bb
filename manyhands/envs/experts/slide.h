// Slide: hit the puck towards the goal. The puck is slippery, so it leaves along the normal where it is touched: for
// goals straight ahead the flat front of the closed fingers, for others their front corner, which is placed on the line
// from the goal through the puck.
#pragma once

#include "manyhands/envs/experts/hand.h"

namespace manyhands::experts {

struct Slide {
  static constexpr const char* kTask = "Slide";
  static constexpr std::size_t kObservation = 18, kGoal = 3, kActions = 3;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), puck = point(row + 6), to_goal = point(goal) - puck;
    const float distance = std::max(std::hypot(to_goal.x, to_goal.y), 1e-6f);
    const Point along{to_goal.x / distance, to_goal.y / distance, 0};
    const float side = std::min(std::abs(to_goal.y) / kStraight, 1.0f) * std::copysign(kCornerY, to_goal.y);
    const Point touch = puck - kRadius * along - Point{kCornerX, side, 0};
    const Point off{hand.x - touch.x, hand.y - touch.y, 0};
    const float ahead = dot(off, along);
    const Point aside = off - ahead * along;
    if (hand.z < kLow + 0.012f && ahead < 0.004f && norm(aside) < kOnLine) {
      const Point move = kHit * along - 20 * aside;
      return {{move.x, move.y, 20 * (kLow - hand.z)}};
    }
    return {approach(hand, touch - kRun * along)};
  }

 private:
  static constexpr float kRadius = 0.03f;  ///< of the puck
  /// Of the finger tips' front corner, from their middle. The fingers are wider above, so only the tips are to hit.
  static constexpr float kCornerX = 0.0105f, kCornerY = 0.018f;
  static constexpr float kStraight = 0.02f;             ///< goals this little aside need no corner
  static constexpr float kLow = 0.034f, kHigh = 0.06f;  ///< aimed at; the hand sags by 1 cm
  static constexpr float kOnLine = 0.008f;
  static constexpr float kRun = 0.03f;  ///< the hit starts this far behind the puck
  static constexpr float kHit = 0.7f;

  /// Comes down on a slope, and rises first where it is low elsewhere, so that the hand does not touch the puck.
  static Point approach(const Point& hand, const Point& start) {
    const float away = flat_distance(hand, start);
    const bool down = away < 0.025f || (hand.z < 0.7f * kHigh && away < 0.035f);
    const float height = down ? kLow : kHigh + std::max(away - 0.03f, 0.0f);
    if (!down && hand.z < 0.75f * kHigh) return {0, 0, 20 * (height - hand.z)};
    return 20 * (Point{start.x, start.y, height} - hand);
  }
};

}  // namespace manyhands::experts
