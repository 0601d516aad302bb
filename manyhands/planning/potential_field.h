// Artificial potential fields: a goal pulls, obstacles push (Khatib, Real-time obstacle avoidance for manipulators and
// mobile robots, Int. J. Robotics Research 5(1), 1986, eqs. 4 and 16).
#pragma once

#include <span>
#include <vector>

namespace manyhands {

/// In a space of any dimension k: of joints, or of points.
///     U_attractive = gain / 2 |q - goal|^2
///     U_repulsive  = sum over obstacles nearer than `influence` of gain / 2 (1 / d - 1 / influence)^2,  d = |q - o|
struct PotentialField {
  double attractive_gain = 1;
  double repulsive_gain = 1;
  double influence = 0.5;  ///< [the unit of q]

  /// Throw std::invalid_argument unless q and goal have the same length k, and obstacles (m, k) are rows of it.
  [[nodiscard]] double attractive(std::span<const double> q, std::span<const double> goal) const;
  /// Infinite where q lies in an obstacle.
  [[nodiscard]] double repulsive(std::span<const double> q, std::span<const double> obstacles) const;
  /// Of both together, (k). An obstacle at q itself, nearer than 1e-10, pushes along the first axis with its gain.
  [[nodiscard]] std::vector<double> gradient(std::span<const double> q, std::span<const double> goal,
                                             std::span<const double> obstacles) const;
};

}  // namespace manyhands
