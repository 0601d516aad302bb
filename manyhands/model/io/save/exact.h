// Numbers that are read back as they were: the shortest texts, and what to write so that a reader's arithmetic ends
// there.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "manyhands/math/quaternion.h"
#include "manyhands/math/vec3.h"

namespace manyhands::io {

/// The shortest text that is read back as the same number.
[[nodiscard]] std::string exact_text(double value);
[[nodiscard]] std::string exact_text(float value);
[[nodiscard]] std::string exact_text(std::span<const double> values);
[[nodiscard]] std::string exact_text(const Vec3<double>& v);

/// The quaternion q, of unit length, for which to_matrix(q) * after is R to the bit; where none is found, one that
/// comes close: within 1e-15 of a rotation.
[[nodiscard]] Quat<double> quat_for(const Mat3<double>& R, const Mat3<double>& after = Mat3<double>::identity());

/// The same for to_quat(to_matrix(q)), which is to be `wanted`.
[[nodiscard]] Quat<double> quat_for(const Quat<double>& wanted);

/// The vector v for which R * v is `wanted` to the bit, or comes closest.
[[nodiscard]] Vec3<double> vector_for(const Mat3<double>& R, const Vec3<double>& wanted);

/// URDF's rpy, for which rotation_from_rpy(rpy) is R to the bit, or comes closest.
[[nodiscard]] Vec3<double> rpy_for(const Mat3<double>& R);

[[nodiscard]] bool same(const Vec3<double>& a, const Vec3<double>& b);
[[nodiscard]] bool same(const Mat3<double>& a, const Mat3<double>& b);

/// The number near `start` for which read(x) is `wanted` to the bit, or comes closest; read grows by `slope` with x.
template <class Read>
[[nodiscard]] double number_for(double start, double wanted, Read read, double slope = 1) {
  constexpr int kSteps = 3, kNeighbours = 16;
  double best = start, error = std::abs(read(start) - wanted);
  const auto consider = [&](double x) {
    const double e = std::abs(read(x) - wanted);
    if (e < error) {
      best = x;
      error = e;
    }
  };
  for (int i = 0; i < kSteps && error > 0; ++i) consider(best + (wanted - read(best)) / slope);
  double below = best, above = best;
  for (int i = 0; i < kNeighbours && error > 0; ++i) {
    below = std::nextafter(below, -std::numeric_limits<double>::infinity());
    above = std::nextafter(above, std::numeric_limits<double>::infinity());
    consider(below);
    consider(above);
  }
  return best;
}

/// The same for points whose coordinates read(p) keeps apart.
template <class Read>
[[nodiscard]] Vec3<double> point_for(const Vec3<double>& start, const Vec3<double>& wanted, Read read) {
  Vec3<double> p = start;
  for (double Vec3<double>::* const x : {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z}) {
    p.*x = number_for(start.*x, wanted.*x, [&](double value) {
      Vec3<double> moved = p;
      moved.*x = value;
      return read(moved).*x;
    });
  }
  return p;
}

}  // namespace manyhands::io
