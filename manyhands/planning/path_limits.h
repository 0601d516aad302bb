// Limits of joints as limits of the motion along a path: inequalities, linear in (ds/dt)^2.
#pragma once

#include "manyhands/planning/time_optimal.h"

namespace manyhands {

/// offset + from x_i + to x_(i+1) <= limit, where x = (ds/dt)^2 at both ends of interval i. Between them d2s/dt2 is
/// constant, so x is linear in s: x = (1 - f) x_i + f x_(i+1) at the fraction f, and d2s/dt2 = (x_(i+1) - x_i) / 2 ds.
struct PathRow {
  double from, to, offset, limit;
};

/// A grid over a path, and what the limits say in every interval.
struct PathLimits {
  static constexpr std::size_t kChecks = 5;  ///< points of an interval: its quarters
  static constexpr bool is_solved(std::size_t check) {
    return check % 2 == 0;
  }  ///< the others are looked at afterwards

  std::vector<double> s;            ///< (n + 1)
  std::vector<std::size_t> pieces;  ///< (n) of the path, in which interval i lies
  std::vector<bool> rests;          ///< (n + 1) where the path turns sharply: x = 0
  std::vector<PathRow> rows;        ///< (n, kChecks, rows_per_check)
  std::size_t rows_per_check = 0;

  [[nodiscard]] std::size_t intervals() const { return pieces.size(); }
  [[nodiscard]] std::span<const PathRow> rows_at(std::size_t interval, std::size_t check) const {
    return std::span(rows).subspan((interval * kChecks + check) * rows_per_check, rows_per_check);
  }
};

/// Throws as `time_optimal`.
[[nodiscard]] PathLimits path_limits(const Trajectory& path, const MotionLimits& limits, std::size_t intervals);

}  // namespace manyhands
