// Points sorted into cubes, so that neighbours are found without looking at all of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "manyhands/math/vec3.h"

namespace manyhands {

using Point = Vec3<double>;

[[nodiscard]] bool is_finite_point(const Point& p);  ///< whether all three numbers are

/// Points (n), which must outlive it, in cubes so small that two points of one lie within reach of each other. Those
/// that are not finite are nowhere.
class PointGrid {
 public:
  using Index = std::array<std::int64_t, 3>;
  struct Cell {
    Index at;
    std::vector<std::size_t> points;  ///< in rising order
    Point low, high;                  ///< corners of the box around them
  };

  /// Throws std::invalid_argument unless reach is finite and above 0.
  PointGrid(std::span<const Point> points, double reach);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  /// The cells, itself included, whose boxes are at most `reach` from its own.
  [[nodiscard]] std::vector<std::size_t> near(const Cell& cell) const;

 private:
  [[nodiscard]] Index index_of(const Point& p) const;

  double reach_;
  std::vector<Cell> cells_;  // sorted by where they are
};

/// Between the nearest points of two boxes, and between their farthest: 0 and the diagonal of a box and itself.
[[nodiscard]] double least_distance(const Point& low_a, const Point& high_a, const Point& low_b, const Point& high_b);
[[nodiscard]] double largest_distance(const Point& low_a, const Point& high_a, const Point& low_b, const Point& high_b);

}  // namespace manyhands
