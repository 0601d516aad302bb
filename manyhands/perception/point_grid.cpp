#include "manyhands/perception/point_grid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace manyhands {

bool is_finite_point(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

PointGrid::PointGrid(std::span<const Point> points, double reach) : points_(points), reach_(reach) {
  if (!std::isfinite(reach) || reach <= 0)
    throw std::invalid_argument("the distance is " + std::to_string(reach) + "; expected a finite number above 0");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_finite_point(points[i])) cells_[cell_of(points[i])].push_back(i);
  }
}

std::size_t PointGrid::Hash::operator()(const Cell& c) const {
  std::uint64_t h = 0;
  for (const std::int64_t x : c) h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15U;
  return h ^ (h >> 32);
}

PointGrid::Cell PointGrid::cell_of(const Point& p) const {
  constexpr double kFarthest = 1e15;  // beyond, cells are shared: slow, and right all the same
  const auto along = [&](double x) {
    return static_cast<std::int64_t>(std::floor(std::clamp(x / reach_, -kFarthest, kFarthest)));
  };
  return {along(p.x), along(p.y), along(p.z)};
}

void PointGrid::near(const Point& p, std::vector<std::size_t>& found) const {
  if (!is_finite_point(p)) return;
  const Cell at = cell_of(p);
  for (std::int64_t i = -1; i <= 1; ++i) {
    for (std::int64_t j = -1; j <= 1; ++j) {
      for (std::int64_t k = -1; k <= 1; ++k) {
        const auto cell = cells_.find({at[0] + i, at[1] + j, at[2] + k});
        if (cell == cells_.end()) continue;
        for (const std::size_t other : cell->second) {
          if (norm(points_[other] - p) <= reach_) found.push_back(other);
        }
      }
    }
  }
}

}  // namespace manyhands
