// Clouds of points from seeds.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "manyhands/math/philox.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/perception/point_grid.h"

namespace manyhands {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Cloud {
 public:
  explicit Cloud(std::uint64_t seed) : random_(seed, 0, 0) {}

  double uniform(double low, double high) {
    return static_cast<double>(random_.uniform(static_cast<float>(low), static_cast<float>(high)));
  }
  Point in_box(const Point& half) {
    return {uniform(-half.x, half.x), uniform(-half.y, half.y), uniform(-half.z, half.z)};
  }
  std::vector<Point> in_box(std::size_t n, const Point& half) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < n; ++i) points.push_back(in_box(half));
    return points;
  }
  Mat3<double> rotation() {
    return to_matrix(normalized(Quat<double>{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}));
  }

 private:
  RandomStream random_;
};

inline Mat3<double> about_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
}

/// The eight corners of a box.
inline std::vector<Point> corners(const Point& half) {
  std::vector<Point> all;
  for (const double x : {-half.x, half.x})
    for (const double y : {-half.y, half.y})
      for (const double z : {-half.z, half.z}) all.push_back({x, y, z});
  return all;
}

inline std::vector<Point> moved(std::span<const Point> points, const Transform<double>& X) {
  std::vector<Point> all;
  for (const Point& p : points) all.push_back(X.R * p + X.p);
  return all;
}

}  // namespace manyhands
