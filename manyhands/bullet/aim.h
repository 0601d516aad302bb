// How the motor of a spherical joint aims.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "manyhands/math/quaternion.h"

namespace manyhands::bullet {

/// The angles about x, y and z, in this order, that PyBullet reads from the rotation from end to start, along the axes
/// of start: near start, minus what leads to end. Three different motors of a spherical joint take them back.
[[nodiscard]] inline Vec3<double> aiming_angles(const Quat<double>& start, const Quat<double>& end) {
  const Mat3<double> A = to_matrix(normalized(start)), B = to_matrix(normalized(end));
  const auto entry = [&](const Vec3<double>& row, const Vec3<double>& column) { return dot(row, column); };
  const double zx = entry(A.z, B.x);  // of transpose(A) B, row z, column x
  if (zx >= 1) return {std::atan2(entry(A.x, B.y), entry(A.y, B.y)), 0.5 * std::numbers::pi, 0};
  if (zx <= -1) return {-std::atan2(entry(A.x, B.y), entry(A.y, B.y)), -0.5 * std::numbers::pi, 0};
  return {std::atan2(-entry(A.z, B.y), entry(A.z, B.z)), std::asin(zx), std::atan2(-entry(A.y, B.x), entry(A.x, B.x))};
}

}  // namespace manyhands::bullet
