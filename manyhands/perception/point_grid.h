// Points sorted into cubes, so that neighbours are found without looking at all of them.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "manyhands/math/vec3.h"

namespace manyhands {

using Point = Vec3<double>;

[[nodiscard]] bool is_finite_point(const Point& p);  ///< whether all three numbers are

/// Points (n), which must outlive it, in cubes of the length `reach`. Those that are not finite are nowhere.
class PointGrid {
 public:
  /// Throws std::invalid_argument unless reach is finite and above 0.
  PointGrid(std::span<const Point> points, double reach);

  /// Appends the indices of the points at most `reach` from p to `found`, in rising order within a cube.
  void near(const Point& p, std::vector<std::size_t>& found) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const;
  };

  [[nodiscard]] Cell cell_of(const Point& p) const;

  std::span<const Point> points_;
  double reach_;
  std::unordered_map<Cell, std::vector<std::size_t>, Hash> cells_;
};

}  // namespace manyhands
