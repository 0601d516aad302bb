#include "manyhands/model/hull_depth.h"

#include <algorithm>
#include <limits>

#include "manyhands/model/qhull_run.h"

namespace manyhands {

double depth_in_hull(std::vector<double> points, std::size_t dimension) {
  if (points.size() / dimension <= dimension) return 0;
  internal::QhullRun run;
  const int count = static_cast<int>(points.size() / dimension);
  if (!run.build(points.data(), count, static_cast<int>(dimension), "qhull Pp")) return 0;
  double depth = std::numeric_limits<double>::infinity();
  for (const facetT* facet : run.facets()) depth = std::min(depth, -facet->offset);
  return std::max(depth, 0.0);
}

}  // namespace manyhands
