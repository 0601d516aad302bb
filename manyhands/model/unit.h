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

/// A rotation that takes z to the unit vector n; none if it is z.
[[nodiscard]] inline Mat3<double> rotation_to_normal(const Vec3<double>& n) {
  if (n.x == 0 && n.y == 0 && n.z > 0) return Mat3<double>::identity();
  const Vec3<double> side = abs(n.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  Vec3<double> y = cross(n, side);
  y = (1 / norm(y)) * y;
  return {cross(y, n), y, n};
}

}  // namespace manyhands
