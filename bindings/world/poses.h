// Rows of vectors and poses that Python gives, checked.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "bindings/arrays.h"
#include "manyhands/math/quaternion.h"

namespace manyhands::bindings {

/// float64 of any shape; what it must be is checked where it is read.
using Numbers = nanobind::ndarray<const double, nanobind::c_contig, nanobind::device::cpu>;

[[nodiscard]] inline std::string shape_of(const Numbers& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// How many rows of `width` numbers: one for shape (width,). Throws std::invalid_argument on other shapes, or if a
/// number is not finite.
[[nodiscard]] inline std::size_t rows_of(const std::string& name, const Numbers& array, std::size_t width) {
  const bool fits = (array.ndim() == 1 || array.ndim() == 2) && array.shape(array.ndim() - 1) == width;
  if (!fits) {
    const std::string w = std::to_string(width);
    throw std::invalid_argument(name + " has shape " + shape_of(array) + "; expected (" + w + ",) or (n, " + w + ")");
  }
  for (const double x : as_span(array)) {
    if (!is_finite(x)) throw std::invalid_argument(name + " holds " + std::to_string(x) + "; expected finite numbers");
  }
  return array.size() / width;
}

[[nodiscard]] inline std::vector<Vec3<double>> vectors(const std::string& name, const Numbers& array) {
  std::vector<Vec3<double>> result(rows_of(name, array, 3));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double* const v = array.data() + 3 * i;
    result[i] = {v[0], v[1], v[2]};
  }
  return result;
}

/// Vectors of length 1 from some of any length above 0. Throws std::invalid_argument on others.
[[nodiscard]] inline std::vector<Vec3<double>> directions(const std::string& name, const Numbers& array) {
  std::vector<Vec3<double>> result = vectors(name, array);
  for (Vec3<double>& d : result) {
    const double length = norm(d);
    if (!(length > 1e-150 && is_finite(length))) {
      throw std::invalid_argument(name + " has a length of " + std::to_string(length) + "; expected one above 0");
    }
    d = (1 / length) * d;
  }
  return result;
}

/// Positions (3,) or (n, 3) and quaternions xyzw (4,) or (n, 4), as many of both. Throws std::invalid_argument unless
/// quaternions have length 1, to 1e-6; they are normalised.
[[nodiscard]] inline std::vector<Transform<double>> poses(const std::string& name, const Numbers& position,
                                                          const Numbers& quaternion) {
  const std::vector<Vec3<double>> p = vectors(name + "'s position", position);
  if (rows_of(name + "'s quaternion", quaternion, 4) != p.size()) {
    throw std::invalid_argument(name + " has positions of shape " + shape_of(position) + " and quaternions of shape " +
                                shape_of(quaternion) + "; expected as many of both");
  }
  std::vector<Transform<double>> result;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double* const r = quaternion.data() + 4 * i;
    const double length2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3];
    if (!(abs(length2 - 1) < 1e-6)) {
      throw std::invalid_argument(name + "'s quaternion (x, y, z, w) has length " + std::to_string(sqrt(length2)) +
                                  "; expected 1");
    }
    result.push_back({to_matrix(normalized(Quat<double>{r[0], r[1], r[2], r[3]})), p[i]});
  }
  return result;
}

}  // namespace manyhands::bindings
