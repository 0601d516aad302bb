#include "manyhands/perception/nearest.h"

#include <algorithm>
#include <limits>

namespace manyhands {

namespace {

double along(const Point& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

}  // namespace

NearestPoints::NearestPoints(std::span<const Point> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_finite_point(points[i])) points_.push_back({points[i], i});
  }
  sort(0, points_.size(), 0);
}

void NearestPoints::sort(std::size_t first, std::size_t last, std::size_t axis) {
  if (last - first < 2) return;
  const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(at(first), at(middle), at(last),
                   [&](const Sorted& a, const Sorted& b) { return along(a.p, axis) < along(b.p, axis); });
  sort(first, middle, (axis + 1) % 3);
  sort(middle + 1, last, (axis + 1) % 3);
}

std::optional<NearestPoints::Found> NearestPoints::find(const Point& query) const {
  if (points_.empty() || !is_finite_point(query)) return std::nullopt;
  Found best{std::numeric_limits<std::size_t>::max(), std::numeric_limits<double>::infinity()};
  search(0, points_.size(), 0, query, best);
  return best;
}

void NearestPoints::search(std::size_t first, std::size_t last, std::size_t axis, const Point& query,
                           Found& best) const {
  if (first == last) return;
  const std::size_t middle = first + (last - first) / 2, next = (axis + 1) % 3;
  const Sorted& here = points_[middle];
  const double distance = norm(here.p - query);
  if (distance < best.distance || (distance == best.distance && here.index < best.index)) best = {here.index, distance};
  const double beyond = along(query, axis) - along(here.p, axis);
  if (beyond < 0) {
    search(first, middle, next, query, best);
    if (-beyond <= best.distance) search(middle + 1, last, next, query, best);
  } else {
    search(middle + 1, last, next, query, best);
    if (beyond <= best.distance) search(first, middle, next, query, best);
  }
}

}  // namespace manyhands
