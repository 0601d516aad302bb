// The plane on which most points lie.
#pragma once

#include <cstdint>
#include <optional>

#include "manyhands/perception/point_grid.h"

namespace manyhands {

/// Points p with normal . p = offset.
struct FoundPlane {
  Point normal;                ///< unit; its largest component is positive
  double offset;               ///< [m]
  std::vector<bool> inliers;   ///< (n) which points lie within the threshold
  std::size_t inlier_count{};  ///< how many
};

struct PlaneSearch {
  double threshold = 0.01;  ///< how far from the plane a point may be [m]
  int iterations = 200;     ///< planes through three random points
  std::uint32_t seed = 0;
  double least_share = 0.1;  ///< of the points; a plane of fewer is none
};

/// The plane with most points within the threshold, by random sample consensus (Fischler, Bolles, 1981), then fitted to
/// them by least squares. None if no plane has the least share of the finite points, or there are less than three.
/// Throws std::invalid_argument unless threshold is finite and above 0 and iterations 1 or more.
[[nodiscard]] std::optional<FoundPlane> find_plane(std::span<const Point> points, const PlaneSearch& search);

}  // namespace manyhands
