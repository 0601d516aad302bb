// manyhands._core.perception: clusters, planes and boxes of points.
#include "bindings/perception/perception.h"

#include <limits>
#include <vector>

#include "bindings/arrays.h"
#include "manyhands/math/quaternion.h"
#include "manyhands/perception/clusters.h"
#include "manyhands/perception/nearest.h"
#include "manyhands/perception/oriented_box.h"
#include "manyhands/perception/plane.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace manyhands {

namespace {

using bindings::Array;
using bindings::copied;

std::vector<Point> points_of(const Array<double, 2>& rows) {
  if (rows.shape(1) != 3) throw std::invalid_argument("points must have the shape (n, 3)");
  std::vector<Point> points;
  for (std::size_t i = 0; i < rows.shape(0); ++i) points.push_back({rows(i, 0), rows(i, 1), rows(i, 2)});
  return points;
}

nb::object clusters(const Array<double, 2>& rows, double reach, int min_samples) {
  const std::vector<Point> points = points_of(rows);
  std::vector<int> labels;
  {
    const nb::gil_scoped_release release;
    labels = dbscan(points, reach, min_samples);
  }
  return copied(labels.data(), {labels.size()});
}

/// Normal (3), offset and inliers (n), or None.
nb::object plane(const Array<double, 2>& rows, double threshold, int iterations, std::uint32_t seed,
                 double least_share) {
  const std::vector<Point> points = points_of(rows);
  std::optional<FoundPlane> found;
  {
    const nb::gil_scoped_release release;
    found = find_plane(points, {threshold, iterations, seed, least_share});
  }
  if (!found) return nb::none();
  const std::vector<unsigned char> inliers(found->inliers.begin(), found->inliers.end());
  return nb::make_tuple(copied(&found->normal.x, {3}), found->offset, bindings::copied_bools(inliers));
}

/// Position (3), quaternion (4) and half extents (3).
nb::tuple box(const Array<double, 2>& rows, bool upright) {
  const OrientedBox found = oriented_box(points_of(rows), upright);
  const Quat<double> r = to_quat(found.X_WB.R);
  return nb::make_tuple(copied(&found.X_WB.p.x, {3}), copied(&r.x, {4}), copied(&found.half_extents.x, {3}));
}

/// Index (m) and distance (m) of the point nearest to each query; -1 and infinity without any.
nb::tuple nearest(const Array<double, 2>& rows, const Array<double, 2>& queries) {
  const std::vector<Point> points = points_of(rows), asked = points_of(queries);
  std::vector<std::int64_t> index(asked.size(), -1);
  std::vector<double> distance(asked.size(), std::numeric_limits<double>::infinity());
  {
    const nb::gil_scoped_release release;
    const NearestPoints cloud(points);
    for (std::size_t k = 0; k < asked.size(); ++k) {
      const std::optional<NearestPoints::Found> found = cloud.find(asked[k]);
      if (found) index[k] = static_cast<std::int64_t>(found->index), distance[k] = found->distance;
    }
  }
  return nb::make_tuple(copied(index.data(), {index.size()}), copied(distance.data(), {distance.size()}));
}

}  // namespace

void bindings::bind_perception(nb::module_& m) {
  nb::module_ perception = m.def_submodule("perception", "Clouds of points; manyhands.perception describes all.");
  perception.def("dbscan", &clusters, "points"_a, "reach"_a, "min_samples"_a);
  perception.def("find_plane", &plane, "points"_a, "threshold"_a, "iterations"_a, "seed"_a, "least_share"_a);
  perception.def("oriented_box", &box, "points"_a, "upright"_a);
  perception.def("nearest", &nearest, "points"_a, "queries"_a);
}

}  // namespace manyhands
