// Flip: roll the cube over the table, face by face, until it comes by the orientation that is asked for. Pressed near
// the edge of its top, and drawn that way, a cube topples over that edge. Lengths, speeds and likeness were chosen by
// trial over 1000 episodes.
#pragma once

#include <array>

#include "manyhands/envs/experts/rolls.h"

namespace manyhands::experts {

class Flip {
 public:
  static constexpr const char* kTask = "Flip";
  static constexpr std::size_t kObservation = 20, kGoal = 4, kActions = 4;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), cube = point(row + 7);
    const Quat<float> pose{row[10], row[11], row[12], row[13]};
    const bool begins = row[3] == 0 && row[4] == 0 && row[5] == 0;
    if (begins) *this = {};
    if (doing_ == Doing::kPress) judge_press(hand, pose);
    if (doing_ == Doing::kDraw && (cube.x < kHome || flat_distance(hand, cube) > 0.025f || steps_ > 14)) come();
    if (doing_ == Doing::kCome) plan(hand, cube, pose, {goal[0], goal[1], goal[2], goal[3]}, norm(point(row + 17)));
    ++steps_;
    switch (doing_) {
      case Doing::kCome:
        return {approach_roll(hand, cube, start_, kTrials)};
      case Doing::kPress:
        return {press_roll(hand, cube, way_, kTrials)};
      case Doing::kDraw:
        break;
    }
    return draw_home(hand, cube);
  }

 private:
  enum class Doing {
    kCome,   ///< above the place where to press
    kPress,  ///< near an edge, until the cube rolls
    kDraw,   ///< the cube nearer to the base, by its middle: at arm's length it cannot be rolled outwards
  };

  static constexpr float kAbove = 0.0563f;  ///< of the hand when a press begins
  static constexpr float kHome = 0.05f, kFar = 0.1f;
  static constexpr RollTrials kTrials{.press_in = 1.12f,
                                      .press_up = 0.615f,
                                      .beside = 0.08f,
                                      .above_within = 0.0076f,
                                      .above = 0.053f,
                                      .slope = 0.66f,
                                      .slope_beyond = 0.03f};

  void come() {
    doing_ = Doing::kCome;
    steps_ = 0;
    way_ = Point::zero();
  }

  /// Ends a press when the cube has rolled, or did not: a hand that slips off presses nearer to the middle the next
  /// time it goes that way, one that only drags the cube along presses farther out.
  void judge_press(const Point& hand, const Quat<float>& pose) {
    constexpr float kNudge = 0.0033f, kMostNudge = 0.0066f;
    constexpr int kMostSteps = 8;
    const float same = likeness(pose, before_);
    const bool slipped = hand.z < 0.0254f && same > 0.97f, drags = steps_ > kMostSteps;
    float& nudge = nudges_[direction()];
    if (slipped) nudge = std::max(nudge - kNudge, -kMostNudge);
    if (!slipped && drags) nudge = std::min(nudge + kNudge, kMostNudge);
    if (slipped || drags || same < 0.66f) come();
  }

  /// Chooses the way, and begins to press or draw where the hand is above a cube that lies.
  void plan(const Point& hand, const Point& cube, const Quat<float>& pose, const Quat<float>& goal, float turning) {
    way_ = next_way(pose, goal, cube);
    const bool draws = way_.x > 0.7f && cube.x > kFar;
    start_ = draws ? cube : place(cube);
    const bool lies = cube.z < 0.022f && turning < 2.7f;
    if (!lies || hand.z > kAbove || flat_distance(hand, start_) > (draws ? 0.012f : 0.0068f)) return;
    doing_ = draws ? Doing::kDraw : Doing::kPress;
    before_ = pose;
    steps_ = 0;
  }

  /// Whether the way leads to the base, from it or aside: the finger tips' widths differ, and so does what an arm does.
  [[nodiscard]] std::size_t direction() const { return way_.x < -0.7f ? 0 : way_.x > 0.7f ? 1 : 2; }

  /// Where to press: near the edge ahead, and less so towards the base, where the hand itself drifts outwards.
  [[nodiscard]] Point place(const Point& cube) const {
    const float in = std::max(-way_.x, 0.0f), out = std::max(way_.x, 0.0f);
    return cube + (0.0257f - 0.0089f * in - 0.0015f * out + nudges_[direction()]) * way_;
  }

  /// The direction in which to roll the cube next. The way chosen before is kept unless another is much better.
  [[nodiscard]] Point next_way(const Quat<float>& pose, const Quat<float>& goal, const Point& cube) const {
    Rolls rolls = rolls_of(pose);
    for (Roll& roll : rolls) {
      if (roll.way.x > 0.5f) roll.extra += cube.x > kFar ? 1.4f : 0.16f;
      if (dot(roll.way, way_) > 0.8f) roll.extra -= 1.69f;
    }
    return next_roll(pose, goal, rolls);
  }

  Doing doing_ = Doing::kCome;
  int steps_ = 0;  ///< since this began
  Point way_ = Point::zero();
  Point start_ = Point::zero();  ///< where the hand comes down
  Quat<float> before_{0, 0, 0, 1};
  std::array<float, 3> nudges_{};  ///< of the place, for each direction
};

}  // namespace manyhands::experts
