#include "manyhands/physics/collision/queries/queries.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "manyhands/base/assert.h"
#include "manyhands/physics/collision/queries/ray_cast.h"
#include "manyhands/physics/dynamics/kinematics.h"

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
  if (!is_finite(r)) return r > 0;
  const Vec to = geoms.pose(g).p - origin;
  const double along = dot(to, direction);
  const Vec aside = to - along * direction;
  return squared_norm(aside) <= r * r && along + r >= 0 && along - r <= far;
}

using GeomPair = std::pair<std::size_t, std::size_t>;

/// What of the pairs, sorted, may touch and is nearer than d, by links.
std::vector<LinkDistance> nearest_of(const PlacedGeoms& geoms, double d, std::span<const GeomPair> pairs) {
  std::map<std::pair<std::size_t, std::size_t>, LinkDistance> found;
  for (const auto& [i, j] : pairs) {
    const std::size_t a = geoms.geom(i).link, b = geoms.geom(j).link;
    if (!(least_distance(geoms, i, j) < d) || !geoms.may_touch(i, j)) continue;
    const auto [pair, is_new] = found.try_emplace({a, b}, LinkDistance{.surfaces = {.phi = d}});
    take_nearer(geoms, i, j, pair->second);
  }
  std::vector<LinkDistance> near;
  for (const auto& [links, distance] : found) {
    if (distance.geom_a.is_valid()) near.push_back(distance);
  }
  return near;
}

/// Calls visit(i, j) for geoms of different links whose balls, grown by d, overlap along x; planes overlap all.
template <class Visit>
void sweep(const PlacedGeoms& geoms, double d, Visit&& visit) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    if (geoms.radius(i) >= 0) order.push_back(i);
  }
  const auto low = [&](std::size_t i) { return geoms.pose(i).p.x - geoms.radius(i); };
  std::ranges::sort(order, {}, low);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double reach = geoms.radius(order[k]) + d, x = geoms.pose(order[k]).p.x;
    const double end = x + reach + 1e-12 * (std::abs(x) + std::abs(reach));  // the balls' distance is rounded, too
    for (std::size_t l = k + 1; l < order.size() && low(order[l]) <= end; ++l) visit(order[k], order[l]);
  }
}

}  // namespace

void GeomPlaces::extend(const Colliders<double>& colliders, const Params<double>& params, const Workspace<double>& ws) {
  for (std::size_t i = X_WG.size(); i < colliders.geoms.size(); ++i) {
    const Collider<double>& geom = colliders.geoms[i];
    const Transform<double> X_WB = body_pose(geom.body, ws);
    X_WG.push_back(X_WB * geom.X_BG);
    radius.push_back(bounding_radius(geom, params.geom_size[geom.geom]));
  }
}

void GeomPlaces::clear() {
  X_WG.clear();
  radius.clear();
}

ShapeView PlacedGeoms::shape(std::size_t i) const {
  const Collider<double>& g = geom(i);
  return {g.type, params_.geom_size[g.geom], g.hull.get(), g.mesh.get(), g.height_field.get()};
}

std::vector<std::size_t> PlacedGeoms::of_link(const Model& model, LinkId link) const {
  std::vector<std::size_t> found;
  for (const GeomId geom : model.geoms_of(link)) {
    const int i = colliders_.collider_of[geom.index()];
    if (i >= 0) found.push_back(static_cast<std::size_t>(i));
  }
  return found;
}

std::optional<LinkDistance> link_distance(const Model& model, const PlacedGeoms& geoms, LinkId a, LinkId b) {
  LinkDistance best{.surfaces = {.phi = kFar}};
  for (const std::size_t i : geoms.of_link(model, a)) {
    for (const std::size_t j : geoms.of_link(model, b)) {
      if (j != i) take_nearer(geoms, i, j, best);
    }
  }
  if (!best.geom_a.is_valid()) return {};
  return best;
}

std::vector<LinkDistance> links_within(const PlacedGeoms& geoms, double d) {
  std::vector<GeomPair> pairs;
  sweep(geoms, d, [&](std::size_t i, std::size_t j) {
    if (!(least_distance(geoms, i, j) < d) || geoms.geom(i).link == geoms.geom(j).link) return;
    const bool in_order = geoms.geom(i).link < geoms.geom(j).link;
    pairs.emplace_back(in_order ? i : j, in_order ? j : i);
  });
  std::ranges::sort(pairs);
  return nearest_of(geoms, d, pairs);
}

std::vector<LinkDistance> links_within(const Model& model, const PlacedGeoms& geoms, double d, LinkId link) {
  std::vector<GeomPair> pairs;
  for (const std::size_t i : geoms.of_link(model, link)) {
    for (std::size_t j = 0; j < geoms.size(); ++j) {
      if (!(least_distance(geoms, i, j) < d) || geoms.geom(j).link == link.index()) continue;
      const bool in_order = link.index() < geoms.geom(j).link;
      pairs.emplace_back(in_order ? i : j, in_order ? j : i);
    }
  }
  std::ranges::sort(pairs);
  return nearest_of(geoms, d, pairs);
}

std::vector<WorldRayHit> ray_cast_all(const PlacedGeoms& geoms, const Vec3<double>& origin,
                                      const Vec3<double>& direction, double far) {
  std::vector<WorldRayHit> hits;
  for (std::size_t g = 0; g < geoms.size(); ++g) {
    if (!may_meet(geoms, g, origin, direction, far)) continue;
    const auto hit = ray_cast(geoms.shape(g), geoms.pose(g), origin, direction, far);
    if (!hit) continue;
    hits.push_back({LinkId(geoms.geom(g).link), GeomId(geoms.geom(g).geom), fma(hit->distance, direction, origin),
                    hit->normal, hit->distance});
  }
  std::ranges::stable_sort(hits, {}, &WorldRayHit::distance);
  return hits;
}

std::vector<std::optional<WorldRayHit>> ray_cast(const PlacedGeoms& geoms, std::span<const Vec3<double>> origins,
                                                 std::span<const Vec3<double>> directions, double far) {
  MANYHANDS_ASSERT(origins.size() == directions.size());
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
