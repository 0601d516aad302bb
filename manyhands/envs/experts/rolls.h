// A cube that lies on a table can be rolled over its four lower edges. Four rolls reach all 24 orientations in which it
// lies, and what they pass on the way comes near to nearly every orientation there is.
#pragma once

#include <array>

#include "manyhands/envs/experts/hand.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::experts {

/// The squared cosine of half the angle between the two.
[[nodiscard]] inline float likeness(const Quat<float>& a, const Quat<float>& b) {
  const float along = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
  return along * along;
}

/// A roll by 90 degrees, and what it passes.
struct Roll {
  static constexpr std::size_t kParts = 6;
  Point way;
  std::array<Quat<float>, kParts> turns;
  float extra = 0;  ///< cost as the first of a plan
};
using Rolls = std::array<Roll, 4>;

/// The rolls over the four lower edges.
[[nodiscard]] inline Rolls rolls_of(const Quat<float>& pose) {
  const Mat3<float> R = to_matrix(pose);
  Point flattest = R.x;
  for (const Point& axis : {R.y, R.z}) {
    if (std::abs(axis.z) < std::abs(flattest.z)) flattest = axis;
  }
  const float length = std::hypot(flattest.x, flattest.y);
  const Point a{flattest.x / length, flattest.y / length, 0}, b{-a.y, a.x, 0};
  Rolls rolls{Roll{.way = a, .turns = {}}, Roll{.way = b, .turns = {}}, Roll{.way = -a, .turns = {}},
              Roll{.way = -b, .turns = {}}};
  for (std::size_t k = 0; k < Roll::kParts; ++k) {
    constexpr float kHalfPart = 0.1308997f;  // half of 15 degrees
    const float half = kHalfPart * static_cast<float>(k + 1), s = std::sin(half), c = std::cos(half);
    for (Roll& roll : rolls) roll.turns[k] = {-s * roll.way.y, s * roll.way.x, 0, c};
  }
  return rolls;
}

/// Cost: the number of rolls, and more where the goal is only just met.
struct RollPlan {
  float cost = 1000;
  std::size_t first = 0;
};

/// Tries all plans of up to four rolls that go on from `so_far`.
inline void search_rolls(const Quat<float>& pose, const Quat<float>& goal, const Rolls& rolls, int depth,
                         const RollPlan& so_far, RollPlan& best) {
  constexpr int kMostRolls = 4;
  for (std::size_t i = 0; i < rolls.size(); ++i) {
    const RollPlan plan{so_far.cost + 1 + (depth == 0 ? rolls[i].extra : 0), depth == 0 ? i : so_far.first};
    if (plan.cost >= best.cost) continue;
    Quat<float> passed = pose;
    for (std::size_t k = 0; k < Roll::kParts; ++k) {
      passed = rolls[i].turns[k] * pose;
      const float sure = k + 1 == Roll::kParts ? 0.946f : 0.935f, margin = likeness(passed, goal) - sure;
      const float doubt = margin > 0 ? 2.9f * std::max(0.1f - margin, 0.0f) : 0.4f - 16.5f * margin;
      if (plan.cost + doubt < best.cost) best = {plan.cost + doubt, plan.first};
    }
    if (depth + 1 < kMostRolls) search_rolls(passed, goal, rolls, depth + 1, plan, best);
  }
}

/// The direction in which to roll the cube next.
[[nodiscard]] inline Point next_roll(const Quat<float>& pose, const Quat<float>& goal, const Rolls& rolls) {
  RollPlan best;
  search_rolls(pose, goal, rolls, 0, {0, 0}, best);
  return rolls[best.first].way;
}

/// What a script of Flip found best by trial, where two of them differ.
struct RollTrials {
  float press_in, press_up;                        ///< towards the base; from it, upwards
  float beside;                                    ///< [m] from the cube a low hand rises first
  float above_within, above, slope, slope_beyond;  ///< [m] near its place; per metre farther off
};

/// Down and on along `way`. An arm that presses drifts outwards, so that way it is to be told little.
[[nodiscard]] inline Point press_roll(const Point& hand, const Point& cube, const Point& way,
                                      const RollTrials& trials) {
  const float out = std::max(way.x, 0.0f), in = std::min(way.x, 0.0f);
  const Point aside{-way.y, way.x, 0};
  Point move = 18.6f * dot(aside, cube - hand) * aside;
  move += Point{0.096f * out + trials.press_in * in + 0.12f * std::abs(way.y), 0.35f * way.y,
                trials.press_up * out - 0.88f};
  return move;
}

/// Towards `start`, where a press begins: down on a slope, and first up beside the cube.
[[nodiscard]] inline Point approach_roll(const Point& hand, const Point& cube, const Point& start,
                                         const RollTrials& trials) {
  const float off = flat_distance(hand, start);
  if (hand.z < 0.05f && flat_distance(hand, cube) < trials.beside) return {0, 0, 20 * (0.118f - hand.z)};
  const float height =
      off < trials.above_within ? trials.above : 0.0689f + trials.slope * std::max(off - trials.slope_beyond, 0.0f);
  return aim(hand, {start.x, start.y, height});
}

/// With a hand that lies on the middle of the cube: nearer to the base.
[[nodiscard]] inline HandAction draw_home(const Point& hand, const Point& cube) {
  return {{-0.8f, 10 * (cube.y - hand.y), 20 * (0.035f - hand.z)}};
}

}  // namespace manyhands::experts
