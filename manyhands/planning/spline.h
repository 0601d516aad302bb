// Interpolating B-splines.
#pragma once

#include "manyhands/planning/polynomials.h"

namespace manyhands {

/// The spline of odd degree 1, 3, 5 or 7 through waypoints at given times; its derivatives up to degree - 1 are
/// continuous. `ends` fixes derivatives at both ends, (2, e, width): velocity, acceleration and so on at the start,
/// then at the end, with e of 0 to (degree - 1) / 2. Knots are the waypoints' times but for those nearest the ends, of
/// which as many are left out as derivatives are open ("not a knot": with e = 0 a cubic is scipy's make_interp_spline).
/// De Boor, A Practical Guide to Splines, 2001, chapters IX, X and XIII: a banded system, solved without pivots.
/// Throws std::invalid_argument as `cubic`, on another degree, and on fewer than degree + 1 - 2 e waypoints.
[[nodiscard]] Trajectory spline(std::span<const double> times, const Waypoints& waypoints, std::size_t degree,
                                std::span<const double> ends);

}  // namespace manyhands
