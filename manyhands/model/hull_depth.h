// How deep the origin lies in the convex hull of points of any dimension.
#pragma once

#include <cstddef>
#include <vector>

namespace manyhands {

/// The radius of the largest ball about the origin within the hull of `points`, rows of `dimension` numbers each: the
/// least distance of its facets, by Qhull. 0 if the origin is not inside, or the points have no volume.
[[nodiscard]] double depth_in_hull(std::vector<double> points, std::size_t dimension);

}  // namespace manyhands
