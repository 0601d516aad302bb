// Trajectories through waypoints: cubic and quintic polynomials, and trapezoids of velocity.
#pragma once

#include "manyhands/planning/trajectory.h"

namespace manyhands {

/// Waypoints (m, width) by rows, m of 2 or more.
struct Waypoints {
  std::span<const double> rows;
  std::size_t width;

  [[nodiscard]] std::size_t count() const { return rows.size() / width; }
  [[nodiscard]] std::span<const double> row(std::size_t i) const { return rows.subspan(i * width, width); }
};

/// A cubic between every two waypoints, which has the velocity (m, width) at each. The acceleration jumps.
/// Throws std::invalid_argument on arrays that do not fit, times that do not rise from 0, and numbers not finite.
[[nodiscard]] Trajectory cubic(std::span<const double> times, const Waypoints& waypoints,
                               std::span<const double> velocity);

/// A quintic between every two waypoints, which has the velocity and acceleration (m, width) at each. Throws as
/// `cubic`.
[[nodiscard]] Trajectory quintic(std::span<const double> times, const Waypoints& waypoints,
                                 std::span<const double> velocity, std::span<const double> acceleration);

/// The fastest motion along the straight line from one waypoint to the next, and the next, at rest at each, that keeps
/// every joint within its velocity and acceleration (width); joints start and stop together. Velocities are trapezoids,
/// or triangles where a line is too short. Throws as `cubic`, on limits not above 0 and on waypoints that repeat.
[[nodiscard]] Trajectory trapezoid(const Waypoints& waypoints, std::span<const double> velocity,
                                   std::span<const double> acceleration);

}  // namespace manyhands
