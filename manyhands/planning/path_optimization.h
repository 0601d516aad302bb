// Smooth paths by optimisation, many at once, of which the best that is proven free is taken.
#pragma once

#include <optional>

#include "manyhands/planning/path_descent.h"

namespace manyhands {

struct OptimizationSettings {
  std::size_t seeds = 16;        ///< paths that are optimised
  std::uint64_t seed = 0;        ///< of what is random in them
  std::size_t points = 20;       ///< control points of each, between its ends
  std::size_t looks = 2;         ///< of each piece, at which obstacles push
  double obstacle_weight = 300;  ///< [1/m]
  SmoothnessWeights smoothness{};
  DescentSettings descent{};
};

/// A path that is free all along, as its waypoints (rows of n) joined by straight lines are.
struct OptimizedPath {
  std::vector<double> waypoints{};
  std::optional<Trajectory> curve{};  ///< cubic, by its length; twice continuously differentiable
  double cost = 0;                    ///< see PathDescent
};

/// What was found: the best path that is free, or where the one that costs least is not.
struct OptimizedPaths {
  std::optional<OptimizedPath> best{};
  std::optional<Encounter> in_the_way{};
};

/// Paths from `start` (n) to `goals` (rows of n), all free and within limits: first straight to each goal, then along
/// arcs past random configurations. The same for the same seed, on any machine, unless time runs out.
[[nodiscard]] OptimizedPaths optimized_paths(const PlanningScene& scene, ConfigurationCheck& check,
                                             std::span<const double> start, std::span<const double> goals,
                                             const OptimizationSettings& settings, const Deadline& deadline);

/// A path that is free (rows of n) made smooth, with obstacles of eight weights; of what is free the one with the
/// lightest. None if none is.
[[nodiscard]] std::optional<OptimizedPath> smoothed(const PlanningScene& scene, ConfigurationCheck& check,
                                                    std::span<const double> rows, const OptimizationSettings& settings,
                                                    const Deadline& deadline);

}  // namespace manyhands
