// What a network is shown besides the observation: how things in it stand to each other and to the goal.
#pragma once

#include <vector>

namespace manyhands::learn {

/// Numbers that can be computed from observation o and goal g, and that tasks turn on: they cost nothing to learn from.
struct Relations {
  /// Pairs (i, k): o[i, i + 3) - o[k, k + 3).
  std::vector<int> differences = {};
  /// i: the quaternion (xyzw) o[i, i + 4) is a cube's rotation, and g the one that is wanted; -1: there is none. Shown
  /// is the rotation from one to the other as a matrix (9, column by column), and how the cube lies, whichever of its
  /// faces is which: the moments sum_k x^a y^b z^c of fourth order over its three axes (15, a + b + c = 4). None of
  /// them has a jump, and the 24 rotations after which a cube looks the same have the same moments.
  int cube_rotation = -1;

  [[nodiscard]] int rotation_dim() const { return cube_rotation >= 0 ? 24 : 0; }
  [[nodiscard]] int difference_dim() const { return 3 * static_cast<int>(differences.size() / 2); }

  /// Throws std::invalid_argument if they are not within an observation, or the goal is no quaternion.
  void require_fit(int observation_dim, int goal_dim) const;

  /// Writes x (rotation_dim() + difference_dim()).
  void write(const float* observation, const float* goal, float* x) const;
};

}  // namespace manyhands::learn
