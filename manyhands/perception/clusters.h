// Clusters of points that lie close together.
#pragma once

#include "manyhands/perception/point_grid.h"

namespace manyhands {

/// For each point (n) the number of its cluster, from 0 on in the order of their first points, or -1 of noise (Ester
/// and others, 1996). A point with `min_samples` points within `reach`, itself included, is a core; cores within reach
/// of each other are one cluster, and so is what lies within reach of a core: of the cluster with the lowest number,
/// where there are several. Points that are not finite are noise. Cells of a side below reach / sqrt(3) keep dense
/// clouds from being compared point by point (Gunawan, A faster algorithm for DBSCAN, 2013). Throws
/// std::invalid_argument unless reach is finite and above 0 and min_samples 1 or more.
[[nodiscard]] std::vector<int> dbscan(std::span<const Point> points, double reach, int min_samples);

}  // namespace manyhands
