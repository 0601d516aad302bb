// Shorter and rounder paths: corners cut, and what corners remain blended.
#pragma once

#include <cstdint>

#include "manyhands/planning/rrt_connect.h"
#include "manyhands/planning/trajectory.h"

namespace manyhands {

struct ShorteningSettings {
  int attempts = 100;      ///< random shortcuts, at most
  int most_failures = 25;  ///< one after the other, after which it ends
  std::uint64_t seed = 0;
};

/// The path (rows of n) with waypoints left out where the way past them is free, then with random shortcuts between
/// points of its edges (Geraerts and Overmars, Creating high-quality paths for motion planning, Int. J. Robotics
/// Research 26(8), 2007). Never longer; its edges are free all along.
[[nodiscard]] std::vector<float> shortened(ConfigurationCheck& check, std::vector<float> rows, std::size_t n,
                                           const ShorteningSettings& settings, const Deadline& deadline);

/// The path with its corners blended by parabolas, each tangent to both edges at the same distance from the corner: at
/// most `reach` [rad or m], and half of either edge; less where that is not free; a corner where none is. The parameter
/// is the length in the space of planned coordinates. Degree 2, and exact: what the result follows was checked.
/// `rows` are two or more, no two in a row the same.
[[nodiscard]] Trajectory blended(ConfigurationCheck& check, std::span<const double> rows, std::size_t n, double reach,
                                 const Deadline& deadline);

/// Of a path, rows of n.
[[nodiscard]] double path_length(std::span<const float> rows, std::size_t n);

}  // namespace manyhands
