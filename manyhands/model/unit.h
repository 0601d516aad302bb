// Directions and rotations at unit length, such that what was written down is read back.
#pragma once

#include "manyhands/math/quaternion.h"

namespace manyhands {

/// Of the square of a length that is 1 but for rounding: four products and their sum.
inline constexpr double kUnitSlack = 4e-15;

/// v at length 1; what has it to rounding stays as it is, so that doing it twice changes nothing.
[[nodiscard]] inline Vec3<double> at_unit_length(const Vec3<double>& v) {
  return abs(squared_norm(v) - 1) <= kUnitSlack ? v : (1 / norm(v)) * v;
}

/// The same for a quaternion.
[[nodiscard]] inline Quat<double> at_unit_length(const Quat<double>& q) {
  const double length2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  return abs(length2 - 1) <= kUnitSlack ? q : normalized(q);
}

}  // namespace manyhands
