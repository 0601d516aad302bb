// How fast a path can be followed: time-optimal parametrisation by reachability analysis.
#pragma once

#include "manyhands/model/model.h"
#include "manyhands/planning/trajectory.h"

namespace manyhands {

/// What a motion keeps within, each (width) or empty. Infinite numbers do not limit.
struct MotionLimits {
  std::span<const double> velocity, acceleration;  ///< [rad/s, m/s], [rad/s^2, m/s^2]
  std::span<const double> torque;                  ///< [N m, N], by the inverse dynamics of `model`
  const Model* model = nullptr;
};

struct TimeOptimalSettings {
  std::size_t intervals = 200;  ///< of the path, in each of which d2s/dt2 is constant; its pieces add their own
  double start_speed = 0, end_speed = 0;  ///< ds/dt at the ends
};

/// The fastest motion along the path q(s), s being the path's time, within the limits: q(s(t)) as polynomials, exactly.
///
/// With x = (ds/dt)^2 and u = d2s/dt2 every limit is an inequality a u + b x + offset <= limit. A pass backward finds
/// at every grid point the x from which the rest can be driven, a pass forward takes the largest u that stays there (H.
/// Pham and Q.-C. Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE T-RO
/// 34(3), 2018). Limits hold at both ends and in the middle of each interval; where they are crossed elsewhere, all are
/// tightened by as much, and the passes run again. Where the path turns sharply the motion stops.
///
/// Throws std::invalid_argument on limits that do not fit, and on a path that cannot be followed, or not with these
/// speeds at its ends: the message says where.
[[nodiscard]] Trajectory time_optimal(const Trajectory& path, const MotionLimits& limits,
                                      const TimeOptimalSettings& settings = {});

}  // namespace manyhands
