// Random shapes and poses for tests of collision, and whether a point lies within a shape.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "manyhands/math/quaternion.h"
#include "manyhands/physics/collision/general/convex.h"

namespace manyhands::testing {

using Point = Vec3<double>;

class ShapeSource {
 public:
  explicit ShapeSource(unsigned seed) : random_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal() { return std::normal_distribution<double>()(random_); }
  Point direction() {
    const Point d{normal(), normal(), normal()};
    return (1 / norm(d)) * d;
  }
  /// A quarter of them along the axes, where features are parallel.
  Mat3<double> rotation() {
    if (uniform(0, 1) < 0.25) {
      const double quarter = 0.5 * std::numbers::pi;
      return to_matrix(quat_from_rotation_vector(Point{0, 0, quarter * std::floor(uniform(0, 4))}) *
                       quat_from_rotation_vector(Point{quarter * std::floor(uniform(0, 4)), 0, 0}));
    }
    return to_matrix(normalized(Quat<double>{normal(), normal(), normal(), normal()}));
  }
  Transform<double> pose(double spread) {
    return {rotation(), {uniform(-spread, spread), uniform(-spread, spread), uniform(-spread, spread)}};
  }
  /// From 0.1 mm to 1 m; a quarter of them far from 1 m.
  double length() { return uniform(0, 1) < 0.25 ? std::exp(uniform(std::log(1e-4), 0)) : uniform(0.2, 1); }

  std::vector<Point> cloud(int n) {
    const Point s{length(), length(), length()};
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) {
      const Point d = direction();
      points.push_back({s.x * d.x, s.y * d.y, s.z * d.z});
    }
    return points;
  }
  ConvexShape shape(ConvexShape::Core core, const std::vector<ConvexPolyhedron>& hulls) {
    using enum ConvexShape::Core;
    switch (core) {
      case kPoint:
        return ConvexShape::sphere(length());
      case kSegment:
        return ConvexShape::capsule(length(), length());
      case kTriangle:
        return ConvexShape::triangle(length() * direction(), length() * direction(), length() * direction());
      case kBox:
        return ConvexShape::box({length(), length(), length()});
      case kCylinder:
        return ConvexShape::cylinder(length(), length());
      case kHull:
        break;
    }
    return ConvexShape::polyhedron(hulls[static_cast<std::size_t>(uniform(0, static_cast<double>(hulls.size())))]);
  }

 private:
  std::mt19937_64 random_;
};

/// How far the point lies outside of the shape [m], 0 within; exact enough to tell inside from outside.
inline double outside(const ConvexShape& s, const Point& p) {
  using enum ConvexShape::Core;
  const auto beyond = [](double x, double limit) { return std::max(0.0, std::abs(x) - limit); };
  switch (s.core) {
    case kPoint:
      return std::max(0.0, norm(p) - s.radius);
    case kSegment:
      return std::max(0.0, std::hypot(p.x, p.y, beyond(p.z, s.size.y)) - s.radius);
    case kBox:
      return std::hypot(beyond(p.x, s.size.x), beyond(p.y, s.size.y), beyond(p.z, s.size.z));
    case kCylinder:
      return std::hypot(beyond(std::hypot(p.x, p.y), s.size.x), beyond(p.z, s.size.y));
    case kTriangle: {
      const auto& [a, b, c] = s.corners;
      const Point n = cross(b - a, c - a);
      double worst = std::abs(dot(n, p - a)) / norm(n);
      for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) {
        const Point out = cross(to - from, n);
        worst = std::max(worst, dot(out, p - from) / norm(out));
      }
      return worst;
    }
    case kHull:
      break;
  }
  double worst = 0;
  for (const auto& plane : s.hull->planes) worst = std::max(worst, dot(plane.normal, p) - plane.offset);
  return worst;
}

}  // namespace manyhands::testing
