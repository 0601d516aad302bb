// Flip without memory: what the hand does follows from what is seen, so that a policy that remembers nothing can learn
// it. It solves fewer episodes than the script that remembers. Lengths and speeds were chosen by trial over 1000
// episodes.
#pragma once

#include "manyhands/envs/experts/rolls.h"

namespace manyhands::experts {

class FlipAtSight {
 public:
  static constexpr const char* kTask = "Flip";
  static constexpr std::size_t kObservation = 20, kGoal = 4, kActions = 4;

  [[nodiscard]] HandAction act(const float* row, const float* goal) const {
    const Scene scene(row);
    if (scene.hand.z < kLow && scene.hand.z > kSlipped) {
      if (draws(scene)) return draw_home(scene.hand, scene.cube);
      for (const Roll& roll : scene.rolls) {
        if (presses(scene, roll.way)) return {press_roll(scene.hand, scene.cube, roll.way, kTrials)};
      }
    }
    const Point there = start(scene, {goal[0], goal[1], goal[2], goal[3]});
    return {approach_roll(scene.hand, scene.cube, there, kTrials)};
  }

 private:
  struct Scene {
    explicit Scene(const float* row)
        : hand(point(row)),
          cube(point(row + 7)),
          pose{row[10], row[11], row[12], row[13]},
          turning(norm(point(row + 17))),
          rolls(rolls_of(pose)) {
      const Mat3<float> R = to_matrix(pose);
      up = R.x;
      for (const Point& axis : {R.y, R.z}) {
        if (std::abs(axis.z) > std::abs(up.z)) up = axis;
      }
      if (up.z < 0) up = -up;
    }

    [[nodiscard]] bool lies() const { return up.z > 0.999f; }

    Point hand, cube;
    Quat<float> pose;
    float turning;  // [rad/s]
    Rolls rolls;
    Point up;  // the cube's most upright axis
  };

  static constexpr float kLow = 0.0575f;     ///< the hand touches the cube, or nearly
  static constexpr float kSlipped = 0.024f;  ///< lower it has slipped off
  static constexpr float kHome = 0.05f, kFar = 0.1f;
  static constexpr RollTrials kTrials{.press_in = 1.044f,
                                      .press_up = 0.624f,
                                      .beside = 0.083f,
                                      .above_within = 0.0077f,
                                      .above = 0.0537f,
                                      .slope = 0.779f,
                                      .slope_beyond = 0.032f};

  /// Whether the hand lies on the middle of a cube that is farther out than it should be.
  static bool draws(const Scene& scene) {
    return scene.lies() && flat_distance(scene.hand, scene.cube) < 0.012f && scene.cube.x > kHome;
  }

  /// Whether the hand is where a roll in this direction begins, or the cube leans that way already.
  static bool presses(const Scene& scene, const Point& way) {
    const Point off = scene.hand - scene.cube;
    const float along = dot(way, off), aside = way.x * off.y - way.y * off.x;
    const float depth = std::clamp((kLow - scene.hand.z) / 0.02f, 0.0f, 1.0f), near = 0.0081f + 0.0105f * depth;
    if (scene.lies()) {
      const bool is_there = std::abs(along - place(way, scene.cube)) < near && std::abs(aside) < near;
      return is_there && (scene.turning < 2.7f || depth > 0.2f);
    }
    const float leaning = scene.up.x * way.x + scene.up.y * way.y;
    return along > 0 && leaning > 0.7f * std::hypot(scene.up.x, scene.up.y);
  }

  /// How far from the middle to press: near the edge ahead, and less so towards the base.
  static float place(const Point& way, const Point& cube) {
    const float in = std::max(-way.x, 0.0f), out = std::max(way.x, 0.0f);
    return 0.0257f - 0.0089f * in - 0.0015f * out + 0.0069f * cube.x + 0.0149f * std::abs(cube.y);
  }

  /// Where to come down: rather near the hand than far from it.
  static Point start(const Scene& scene, const Quat<float>& goal) {
    Rolls rolls = scene.rolls;
    for (Roll& roll : rolls) {
      if (roll.way.x > 0.5f) roll.extra += scene.cube.x > kFar ? 1.54f : 0.124f;
      const Point there = scene.cube + place(roll.way, scene.cube) * roll.way;
      roll.extra += 33.8f * std::min(flat_distance(scene.hand, there), 0.06f);
    }
    const Point way = next_roll(scene.pose, goal, rolls);
    const bool draws = way.x > 0.7f && scene.cube.x > kFar;
    return draws ? scene.cube : scene.cube + place(way, scene.cube) * way;
  }
};

}  // namespace manyhands::experts
