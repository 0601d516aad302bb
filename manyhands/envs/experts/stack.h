// Stack: the first cube to its goal, then the second on top. If the second is in the way it goes first: drawn aside by
// pressing on it where the fingers would not fit between the cubes, else taken and parked.
#pragma once

#include "manyhands/envs/experts/grasp.h"

namespace manyhands::experts {

struct Stack {
  static constexpr const char* kTask = "Stack";
  static constexpr std::size_t kObservation = 31, kGoal = 6, kActions = 4;

  [[nodiscard]] HandAction act(const float* row, const float* goal) {
    const Point hand = point(row), first = point(row + 7), second = point(row + 19), place = point(goal);
    const bool is_placed = norm(place - first) < 0.045f && std::abs(first.z - kHalf) < 0.008f;
    const Point apart = second - first;
    const bool on_top = apart.z > 0.025f && std::abs(apart.x) < 2 * kHalf && std::abs(apart.y) < 2 * kHalf;
    const bool takes_the_place = !on_top && flat_distance(second, place) < 0.075f;
    const Grasp grasp{.clear_top = std::max(first.z, second.z) + 2 * kHalf, .lift = 0.055f, .let_go = !is_placed};
    if (is_placed) return move_cube(row, second, {first.x, first.y, first.z + 2 * kHalf}, grasp);
    if (on_top || takes_the_place) return move_cube(row, second, parking(first, place), grasp);
    const bool fingers_fit = on_top || std::abs(apart.x) > 0.035f || std::abs(apart.y) > 0.088f;
    if (!fingers_fit && !holds(hand, row[6], first)) return draw_aside(hand, second, apart.y, grasp.clear_top);
    return move_cube(row, first, place, grasp);
  }

 private:
  static constexpr float kHalf = 0.02f;  ///< a cube's

  static HandAction move_cube(const float* row, const Point& cube, const Point& place, const Grasp& grasp) {
    const Point hand = point(row);
    return holds(hand, row[6], cube) ? carry(hand, cube, place, grasp) : fetch(hand, cube, grasp);
  }

  /// Away from the goal and from the first cube.
  static Point parking(const Point& first, const Point& place) {
    Point p{place.x + (place.x > 0 ? -0.13f : 0.13f), place.y, kHalf};
    if (flat_distance(p, first) < 0.12f) p.y = first.y - std::copysign(0.14f, first.y);
    return p;
  }

  /// Presses on the cube with closed fingers and moves it along y, the way in which it already is off (`side`).
  static HandAction draw_aside(const Point& hand, const Point& cube, float side, float clear_top) {
    const float off = flat_distance(hand, cube);
    const bool on_it = off < 0.018f && hand.z < cube.z + 0.034f;
    Point move = aim(hand, {cube.x, cube.y, cube.z + (off < 0.01f ? 0.015f : 0.06f)});
    if (hand.z < 0.13f) move.z = std::max(move.z, -0.4f);
    const bool is_low = off > 0.03f && hand.z < clear_top;
    if (on_it || is_low) move.x = move.y = 0;
    if (on_it) move.y = std::copysign(0.5f, side);
    return {move, -1};
  }
};

}  // namespace manyhands::experts
