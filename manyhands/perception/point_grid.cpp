#include "manyhands/perception/point_grid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace manyhands {

bool is_finite_point(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

PointGrid::PointGrid(std::span<const Point> points, double reach) : reach_(reach) {
  if (!std::isfinite(reach) || reach <= 0)
    throw std::invalid_argument("the distance is " + std::to_string(reach) + "; expected a finite number above 0");
  std::vector<std::pair<Index, std::size_t>> sorted;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_finite_point(points[i])) sorted.emplace_back(index_of(points[i]), i);
  }
  std::ranges::sort(sorted);
  for (const auto& [at, i] : sorted) {
    const Point& p = points[i];
    if (cells_.empty() || cells_.back().at != at) cells_.push_back({at, {}, p, p});
    Cell& cell = cells_.back();
    cell.points.push_back(i);
    cell.low = {std::min(cell.low.x, p.x), std::min(cell.low.y, p.y), std::min(cell.low.z, p.z)};
    cell.high = {std::max(cell.high.x, p.x), std::max(cell.high.y, p.y), std::max(cell.high.z, p.z)};
  }
}

PointGrid::Index PointGrid::index_of(const Point& p) const {
  constexpr double kSide = 0.51;      // of reach: below 1 / sqrt(3), and two cells span reach in spite of rounding
  constexpr double kFarthest = 1e14;  // beyond, cells are shared: slow, and right all the same
  const auto along = [&](double x) {
    return static_cast<std::int64_t>(std::floor(std::clamp(x / reach_ / kSide, -kFarthest, kFarthest)));
  };
  return {along(p.x), along(p.y), along(p.z)};
}

std::vector<std::size_t> PointGrid::near(const Cell& cell) const {
  std::vector<std::size_t> near;
  for (std::int64_t i = -2; i <= 2; ++i) {
    for (std::int64_t j = -2; j <= 2; ++j) {
      const Index first{cell.at[0] + i, cell.at[1] + j, cell.at[2] - 2}, last{first[0], first[1], first[2] + 4};
      for (auto at = std::ranges::lower_bound(cells_, first, {}, &Cell::at); at != cells_.end() && at->at <= last;
           ++at) {
        if (least_distance(cell.low, cell.high, at->low, at->high) <= reach_)
          near.push_back(static_cast<std::size_t>(at - cells_.begin()));
      }
    }
  }
  return near;
}

double least_distance(const Point& low_a, const Point& high_a, const Point& low_b, const Point& high_b) {
  const auto gap = [](double a, double b) { return std::max({0.0, a, b}); };
  return norm(Point{gap(low_a.x - high_b.x, low_b.x - high_a.x), gap(low_a.y - high_b.y, low_b.y - high_a.y),
                    gap(low_a.z - high_b.z, low_b.z - high_a.z)});
}

double largest_distance(const Point& low_a, const Point& high_a, const Point& low_b, const Point& high_b) {
  return norm(Point{std::max(high_a.x - low_b.x, high_b.x - low_a.x), std::max(high_a.y - low_b.y, high_b.y - low_a.y),
                    std::max(high_a.z - low_b.z, high_b.z - low_a.z)});
}

}  // namespace manyhands
