#include "manyhands/model/io/ellipsoid_points.h"

#include <algorithm>

#include "manyhands/model/io/text_numbers.h"

namespace manyhands::io {

namespace {

std::vector<Vec3<double>> points_on_sphere() {
  constexpr double kGolden = 1.618033988749895;
  std::vector<Vec3<double>> points;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-kGolden, kGolden}) {
      points.push_back({0, a, b});
      points.push_back({a, b, 0});
      points.push_back({b, 0, a});
    }
  }
  for (int cut = 0; cut < 2; ++cut) {
    double shortest = norm(points[0] - points[1]);
    for (std::size_t i = 1; i < points.size(); ++i) shortest = std::min(shortest, norm(points[0] - points[i]));
    const std::size_t count = points.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        // Neighbours: the next points on the sphere are 1.7 times as far.
        if (norm(points[i] - points[k]) < 1.35 * shortest) points.push_back(0.5 * (points[i] + points[k]));
      }
    }
    for (Vec3<double>& p : points) p = (1 / norm(p)) * p;
  }
  return points;
}

}  // namespace

Mesh points_on_ellipsoid(const Vec3<double>& s) {
  static const std::vector<Vec3<double>> kPoints = points_on_sphere();
  Mesh mesh{.source = "ellipsoid " + format_number(s.x) + " " + format_number(s.y) + " " + format_number(s.z)};
  for (const Vec3<double>& p : kPoints) {
    mesh.vertices.push_back(
        {static_cast<float>(s.x * p.x), static_cast<float>(s.y * p.y), static_cast<float>(s.z * p.z)});
  }
  return mesh;
}

}  // namespace manyhands::io
