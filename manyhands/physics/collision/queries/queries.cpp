#include "manyhands/physics/collision/queries/queries.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "manyhands/physics/collision/queries/ray_cast.h"

namespace manyhands {
namespace {

using Vec = Vec3<double>;

constexpr double kFar = std::numeric_limits<double>::infinity();

/// No more than the distance of two geoms: that of the balls that hold them, or of the ball and a plane.
double least_distance(const PlacedGeoms& geoms, std::size_t a, std::size_t b) {
  if (geoms.geom(a).type == ShapeType::kPlane) std::swap(a, b);
  const Vec apart = geoms.pose(a).p - geoms.pose(b).p;
  if (geoms.geom(b).type == ShapeType::kPlane) return dot(geoms.pose(b).R.z, apart) - geoms.radius(a);
  return norm(apart) - geoms.radius(a) - geoms.radius(b);
}

/// The two geoms' distance into `best`, if it is smaller.
void take_nearer(const PlacedGeoms& geoms, std::size_t a, std::size_t b, LinkDistance& best) {
  if (!(least_distance(geoms, a, b) < best.surfaces.phi)) return;
  const auto d = signed_distance(geoms.shape(a), geoms.pose(a), geoms.shape(b), geoms.pose(b));
  if (!(d.phi < best.surfaces.phi)) return;
  best = {LinkId(geoms.geom(a).link), LinkId(geoms.geom(b).link), GeomId(geoms.geom(a).geom),
          GeomId(geoms.geom(b).geom), d};
}

/// The ray comes within the geom's ball at a distance of no more than `far`.
bool may_meet(const PlacedGeoms& geoms, std::size_t g, const Vec& origin, const Vec& direction, double far) {
  const double r = geoms.radius(g) * (1 + 1e-9);
  if (!is_finite(r)) return true;
  const Vec to = geoms.pose(g).p - origin;
  const double along = dot(to, direction);
  const Vec aside = to - along * direction;
  return squared_norm(aside) <= r * r && along + r >= 0 && along - r <= far;
}

}  // namespace

PlacedGeoms::PlacedGeoms(const Colliders<double>& colliders, const Params<double>& params, const Workspace<double>& ws)
    : colliders_(colliders), params_(params) {
  for (const Collider<double>& geom : colliders.geoms) {
    const Transform<double> X_WB{ws.R_WB[geom.body], ws.p_OB[geom.body] + ws.p_WO[geom.body]};
    X_WG_.push_back(X_WB * geom.X_BG);
    radius_.push_back(bounding_radius(geom, params.geom_size[geom.geom]));
  }
}

ShapeView PlacedGeoms::shape(std::size_t i) const {
  const Collider<double>& g = geom(i);
  return {g.type, params_.geom_size[g.geom], g.hull.get(), g.mesh.get(), g.height_field.get()};
}

std::optional<LinkDistance> link_distance(const PlacedGeoms& geoms, LinkId a, LinkId b) {
  LinkDistance best{.surfaces = {.phi = kFar}};
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms.geom(i).link != a.index()) continue;
    for (std::size_t j = 0; j < geoms.size(); ++j) {
      if (geoms.geom(j).link == b.index() && j != i) take_nearer(geoms, i, j, best);
    }
  }
  if (!best.geom_a.is_valid()) return {};
  return best;
}

std::vector<LinkDistance> links_within(const PlacedGeoms& geoms, double d) {
  std::map<std::pair<std::size_t, std::size_t>, LinkDistance> found;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    for (std::size_t j = 0; j < geoms.size(); ++j) {
      const std::size_t a = geoms.geom(i).link, b = geoms.geom(j).link;
      if (a >= b || !(least_distance(geoms, i, j) < d) || !geoms.may_touch(i, j)) continue;
      const auto [pair, is_new] = found.try_emplace({a, b}, LinkDistance{.surfaces = {.phi = d}});
      take_nearer(geoms, i, j, pair->second);
    }
  }
  std::vector<LinkDistance> near;
  for (const auto& [links, distance] : found) {
    if (distance.geom_a.is_valid()) near.push_back(distance);
  }
  return near;
}

std::vector<std::optional<WorldRayHit>> ray_cast(const PlacedGeoms& geoms, std::span<const Vec3<double>> origins,
                                                 std::span<const Vec3<double>> directions, double far) {
  assert(origins.size() == directions.size());
  std::vector<std::optional<WorldRayHit>> hits(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    double reach = far;
    for (std::size_t g = 0; g < geoms.size(); ++g) {
      if (!may_meet(geoms, g, origins[i], directions[i], reach)) continue;
      const auto hit = ray_cast(geoms.shape(g), geoms.pose(g), origins[i], directions[i], reach);
      if (!hit || (hits[i] && !(hit->distance < reach))) continue;
      reach = hit->distance;
      hits[i] = {LinkId(geoms.geom(g).link), GeomId(geoms.geom(g).geom), fma(reach, directions[i], origins[i]),
                 hit->normal, reach};
    }
  }
  return hits;
}

}  // namespace manyhands
