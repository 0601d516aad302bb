// The convex hull of points.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "manyhands/math/vec3.h"

namespace manyhands {

/// The triangles of the hull, as indices of the points, counter-clockwise seen from outside; none if the points are
/// fewer than four or lie in a plane. Points within 1e-7 of the extent of a face may be left out. Takes time in
/// proportion to points times faces.
[[nodiscard]] std::vector<std::array<int, 3>> convex_hull(std::span<const Vec3<float>> points);

}  // namespace manyhands
