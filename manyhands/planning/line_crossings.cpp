#include "manyhands/planning/line_crossings.h"

#include <algorithm>

#include "manyhands/physics/collision/queries/ray_cast.h"

namespace manyhands {

namespace {

using Vec = Vec3<double>;

constexpr double kMeet = 1e-9;  // stretches that are no farther apart are one [m]

/// Of a convex shape: one ray from each end.
void cross_solid(const PlacedShape& placed, const Vec& o, const Vec& d, double reach, std::vector<Crossing>& found) {
  const auto in = ray_cast<double>(placed.shape, placed.X, o - reach * d, d, 2 * reach);
  if (!in) return;
  const auto out = ray_cast<double>(placed.shape, placed.X, o + reach * d, -d, 2 * reach);
  if (!out) return;
  found.push_back({in->distance - reach, reach - out->distance, in->normal, out->normal});
}

/// Of a mesh: from one triangle to the next.
void cross_mesh(const PlacedShape& placed, const Vec& o, const Vec& d, double reach, std::vector<Crossing>& found) {
  const double past = kMeet * (1 + reach + norm(o));  // a hit, beyond rounding
  double t = -reach;
  bool inside = false;
  Crossing next;
  while (const auto hit = ray_cast<double>(placed.shape, placed.X, fma(t, d, o), d, reach - t)) {
    t += hit->distance;
    if (inside) {
      next.to = t;
      next.normal_to = -hit->normal;  // rays see triangles from both sides
      found.push_back(next);
    } else {
      next.from = t;
      next.normal_from = hit->normal;
    }
    inside = !inside;
    t += past;
  }
}

}  // namespace

std::vector<Crossing> crossings(std::span<const PlacedShape> shapes, const Vec& o, const Vec& d, double reach) {
  std::vector<Crossing> found;
  for (const PlacedShape& placed : shapes) {
    if (placed.shape.is_convex_body())
      cross_solid(placed, o, d, reach, found);
    else
      cross_mesh(placed, o, d, reach, found);
  }
  std::ranges::sort(found, {}, &Crossing::from);
  std::vector<Crossing> merged;
  for (const Crossing& next : found) {
    if (merged.empty() || next.from > merged.back().to + kMeet) {
      merged.push_back(next);
    } else if (next.to > merged.back().to) {
      merged.back().to = next.to;
      merged.back().normal_to = next.normal_to;
    }
  }
  return merged;
}

}  // namespace manyhands
