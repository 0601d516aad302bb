// Taking a cube of 4 cm with the open hand from above, and carrying it.
#pragma once

#include "manyhands/envs/experts/hand.h"

namespace manyhands::experts {

struct Grasp {
  float clear_top = 0.04f;  ///< the hand travels empty above this height of obstacles
  float lift = 0;           ///< a held cube travels this high above its place
  bool let_go = false;      ///< at its place
};

/// Where the hand is with a cube. Fingers that are not wide open about the cube hold it: they close in one step.
[[nodiscard]] inline bool holds(const Point& hand, float width, const Point& cube) {
  return width < 0.062f && flat_distance(hand, cube) < 0.02f && std::abs(hand.z - cube.z) < 0.02f;
}

/// One step of fetching the cube with an empty hand.
[[nodiscard]] inline HandAction fetch(const Point& hand, const Point& cube, const Grasp& grasp) {
  const float off = flat_distance(hand, cube), top = grasp.clear_top + 0.005f;
  const bool above = off < 0.01f || (off < 0.02f && hand.z < cube.z + 0.03f);
  Point target = cube;
  if (!above) target.z = std::max(cube.z + 0.06f, off > 0.05f ? top + 0.01f : 0.0f);
  if (!above && off > 0.03f && hand.z < top - 0.005f) {
    target.x = hand.x;
    target.y = hand.y;
  }
  const bool there = off < 0.008f && std::abs(hand.z - cube.z) < 0.008f;
  Point move = aim(hand, target);
  if (hand.z < 0.13f) move.z = std::max(move.z, -0.6f);
  return {move, there ? -1.0f : 1.0f};
}

/// One step of carrying a held cube to its place: up first if it travels high.
[[nodiscard]] inline HandAction carry(const Point& hand, const Point& cube, const Point& place, const Grasp& grasp) {
  const float off = flat_distance(cube, place);
  Point target = place + (hand - cube);
  if (off > 0.02f) target.z += grasp.lift;
  if (off > 0.04f && cube.z < place.z + 0.5f * grasp.lift) {
    target.x = hand.x + 0.25f * (target.x - hand.x);
    target.y = hand.y + 0.25f * (target.y - hand.y);
  }
  const bool there = off < 0.015f && std::abs(place.z - cube.z) < 0.01f;
  return {0.75f * aim(hand, target), grasp.let_go && there ? 1.0f : -1.0f};
}

}  // namespace manyhands::experts
