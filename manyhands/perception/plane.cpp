#include "manyhands/perception/plane.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "manyhands/math/philox.h"
#include "manyhands/perception/principal_axes.h"

namespace manyhands {

namespace {

struct Plane {
  Point normal;
  double offset;

  [[nodiscard]] bool holds(const Point& p, double threshold) const {
    return std::abs(dot(normal, p) - offset) <= threshold;
  }
};

std::size_t count_inliers(const Plane& plane, std::span<const Point> points, double threshold) {
  return static_cast<std::size_t>(
      std::ranges::count_if(points, [&](const Point& p) { return plane.holds(p, threshold); }));
}

std::optional<Plane> through(const Point& a, const Point& b, const Point& c) {
  const Point normal = cross(b - a, c - a);
  const double length = norm(normal);
  if (!(length > 1e-12 * norm(b - a) * norm(c - a))) return std::nullopt;
  const Point unit = (1 / length) * normal;
  return Plane{unit, dot(unit, a)};
}

/// The least squares fit to what lies within the threshold of a plane.
Plane fitted(const Plane& plane, std::span<const Point> points, double threshold) {
  std::vector<Point> inliers;
  for (const Point& p : points) {
    if (plane.holds(p, threshold)) inliers.push_back(p);
  }
  const PrincipalAxes axes = principal_axes(inliers);
  return {axes.axes.z, dot(axes.axes.z, axes.mean)};
}

void check(const PlaneSearch& search) {
  if (!std::isfinite(search.threshold) || search.threshold <= 0)
    throw std::invalid_argument("threshold is " + std::to_string(search.threshold) +
                                "; expected a finite number above 0");
  if (search.iterations < 1)
    throw std::invalid_argument("iterations is " + std::to_string(search.iterations) + "; expected 1 or more");
}

}  // namespace

std::optional<FoundPlane> find_plane(std::span<const Point> points, const PlaneSearch& search) {
  check(search);
  std::vector<Point> finite;
  std::ranges::copy_if(points, std::back_inserter(finite), is_finite_point);
  if (finite.size() < 3) return std::nullopt;
  RandomStream random(search.seed, 0, 0);
  const auto pick = [&] {
    const auto at =
        static_cast<std::size_t>(static_cast<double>(random.uniform(0.0F, 1.0F)) * static_cast<double>(finite.size()));
    return finite[std::min(at, finite.size() - 1)];
  };
  std::optional<Plane> best;
  std::size_t most = 0;
  for (int i = 0; i < search.iterations; ++i) {
    const Point a = pick(), b = pick(), c = pick();
    const std::optional<Plane> plane = through(a, b, c);
    if (!plane) continue;
    const std::size_t count = count_inliers(*plane, finite, search.threshold);
    if (count > most) most = count, best = plane;
  }
  if (!best || static_cast<double>(most) < search.least_share * static_cast<double>(finite.size())) return std::nullopt;
  const Plane refined = fitted(*best, finite, search.threshold);
  if (count_inliers(refined, finite, search.threshold) >= most) best = refined;

  const Point& n = best->normal;
  const double largest = std::max({n.x, n.y, n.z, -n.x, -n.y, -n.z});
  const double sign = largest == n.x || largest == n.y || largest == n.z ? 1 : -1;
  FoundPlane found{sign * n, sign * best->offset, {}};
  for (const Point& p : points) {
    found.inliers.push_back(is_finite_point(p) && best->holds(p, search.threshold));
    if (found.inliers.back()) ++found.inlier_count;
  }
  return found;
}

}  // namespace manyhands
