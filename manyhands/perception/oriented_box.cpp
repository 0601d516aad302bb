#include "manyhands/perception/oriented_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "manyhands/perception/principal_axes.h"

namespace manyhands {

namespace {

using Corner = std::array<double, 2>;

double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The convex hull from above, counter-clockwise (Andrew's monotone chain).
std::vector<Corner> outline(std::span<const Point> points) {
  std::vector<Corner> all;
  for (const Point& p : points) all.push_back({p.x, p.y});
  std::ranges::sort(all);
  std::vector<Corner> hull;
  const auto chain = [&](auto begin, auto end) {
    const std::size_t least = hull.size() + 1;
    for (auto it = begin; it != end; ++it) {
      while (hull.size() > least && turn(hull[hull.size() - 2], hull.back(), *it) <= 0) hull.pop_back();
      hull.push_back(*it);
    }
    hull.pop_back();
  };
  chain(all.begin(), all.end());
  chain(all.rbegin(), all.rend());
  if (hull.empty()) hull.push_back(all.front());
  return hull;
}

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double x) { low = std::min(low, x), high = std::max(high, x); }
  [[nodiscard]] double length() const { return high - low; }
};

/// The box along the columns of R.
OrientedBox box_along(const Mat3<double>& R, std::span<const Point> points) {
  std::array<Interval, 3> range;
  for (const Point& p : points) {
    const Point at = transpose_times(R, p);
    range[0].take(at.x), range[1].take(at.y), range[2].take(at.z);
  }
  const auto middle = [&](std::size_t i) { return (range[i].low + range[i].high) / 2; };
  return {{R, R * Point{middle(0), middle(1), middle(2)}},
          {range[0].length() / 2, range[1].length() / 2, range[2].length() / 2}};
}

Mat3<double> upright_axes(std::span<const Point> points) {
  const std::vector<Corner> hull = outline(points);
  double least = std::numeric_limits<double>::infinity();
  Point x{1, 0, 0};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Corner &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (length == 0) continue;
    const double c = (b[0] - a[0]) / length, s = (b[1] - a[1]) / length;
    Interval along, across;
    for (const Corner& p : hull) along.take(c * p[0] + s * p[1]), across.take(c * p[1] - s * p[0]);
    const double area = along.length() * across.length();
    if (area >= least) continue;
    least = area;
    x = along.length() >= across.length() ? Point{c, s, 0} : Point{-s, c, 0};
  }
  return {x, {-x.y, x.x, 0}, {0, 0, 1}};
}

}  // namespace

OrientedBox oriented_box(std::span<const Point> points, bool upright) {
  std::vector<Point> finite;
  std::ranges::copy_if(points, std::back_inserter(finite), is_finite_point);
  if (finite.empty()) throw std::invalid_argument("there is no finite point to put a box around");
  return box_along(upright ? upright_axes(finite) : principal_axes(finite).axes, finite);
}

}  // namespace manyhands
