// Which point of a cloud lies nearest.
#pragma once

#include <optional>

#include "manyhands/perception/point_grid.h"

namespace manyhands {

/// Points (n) sorted into a tree of halves (Bentley, 1975), so that a query looks at few of them. Those that are not
/// finite are nowhere. Knows no more of the points than a copy.
class NearestPoints {
 public:
  struct Found {
    std::size_t index;  ///< of the point; the lowest, where several are as near
    double distance;    ///< [m]
  };

  explicit NearestPoints(std::span<const Point> points);

  /// The point nearest to the query; none if there is no finite point, or the query is not finite.
  [[nodiscard]] std::optional<Found> find(const Point& query) const;

 private:
  struct Sorted {
    Point p;
    std::size_t index;
  };

  void sort(std::size_t first, std::size_t last, std::size_t axis);
  void search(std::size_t first, std::size_t last, std::size_t axis, const Point& query, Found& best) const;

  std::vector<Sorted> points_{};  // the middle one of a range parts the others along its axis
};

}  // namespace manyhands
