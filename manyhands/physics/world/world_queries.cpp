// World: how far links are from each other, and what rays meet.
#include <cmath>

#include "manyhands/physics/world/world_impl.h"

namespace manyhands {

namespace {

PlacedGeoms placed_geoms(const WorldCore& core) { return {core.system.colliders, core.params, core.placed_geoms()}; }

/// With the ids of `World::model`.
void show(const WorldCore& core, LinkDistance& d) {
  d.link_a = core.shown(d.link_a);
  d.link_b = core.shown(d.link_b);
  d.geom_a = core.shown(d.geom_a);
  d.geom_b = core.shown(d.geom_b);
}

void require_number(double d) {
  if (std::isnan(d)) throw std::invalid_argument("the distance is not a number; expected one in metres");
}

}  // namespace

std::optional<LinkDistance> World::distance(std::string_view link_a, std::string_view link_b) const {
  const WorldCore& now = loose();
  const LinkId a = now.model->link_id(link_a), b = now.model->link_id(link_b);
  if (a == b) {
    throw std::invalid_argument("the distance of link '" + std::string(link_a) +
                                "' from itself was asked for; name two links");
  }
  std::optional<LinkDistance> found = manyhands::link_distance(*now.model, placed_geoms(now), a, b);
  if (found) show(now, *found);
  return found;
}

std::vector<LinkDistance> World::near_links(double d) const {
  require_number(d);
  const WorldCore& now = loose();
  std::vector<LinkDistance> found = links_within(placed_geoms(now), d);
  for (LinkDistance& pair : found) show(now, pair);
  return found;
}

std::vector<LinkDistance> World::near_links(double d, std::string_view link) const {
  require_number(d);
  const WorldCore& now = loose();
  std::vector<LinkDistance> found = links_within(*now.model, placed_geoms(now), d, now.model->link_id(link));
  for (LinkDistance& pair : found) show(now, pair);
  return found;
}

namespace {

/// Throws std::invalid_argument.
Vec3<double> unit_of_ray(const Vec3<double>& origin, const Vec3<double>& direction, std::size_t i) {
  internal::require_vector("origin", origin);
  const double length = norm(direction);
  if (!(length > 1e-150 && is_finite(length))) {
    throw std::invalid_argument("direction " + std::to_string(i) + " has a length of " + std::to_string(length) +
                                "; expected a finite one above 0");
  }
  return (1 / length) * direction;
}

void require_reach(double max_distance) {
  if (max_distance >= 0) return;
  throw std::invalid_argument("max_distance is " + std::to_string(max_distance) + " m; expected 0 or more");
}

WorldRayHit shown(const WorldCore& now, WorldRayHit hit) {
  hit.link = now.shown(hit.link);
  hit.geom = now.shown(hit.geom);
  return hit;
}

}  // namespace

std::vector<std::optional<WorldRayHit>> World::ray_cast(std::span<const Vec3<double>> origins,
                                                        std::span<const Vec3<double>> directions,
                                                        double max_distance) const {
  if (origins.size() != directions.size()) {
    throw std::invalid_argument("there are " + std::to_string(origins.size()) + " origins and " +
                                std::to_string(directions.size()) + " directions of rays; expected as many of both");
  }
  require_reach(max_distance);
  std::vector<Vec3<double>> unit;
  for (std::size_t i = 0; i < origins.size(); ++i) unit.push_back(unit_of_ray(origins[i], directions[i], i));
  const WorldCore& now = loose();
  std::vector<std::optional<WorldRayHit>> hits = manyhands::ray_cast(placed_geoms(now), origins, unit, max_distance);
  for (std::optional<WorldRayHit>& hit : hits) {
    if (hit) hit = shown(now, *hit);
  }
  return hits;
}

std::vector<WorldRayHit> World::ray_cast_all(const Vec3<double>& origin, const Vec3<double>& direction,
                                             double max_distance) const {
  require_reach(max_distance);
  const Vec3<double> unit = unit_of_ray(origin, direction, 0);
  const WorldCore& now = loose();
  std::vector<WorldRayHit> hits = manyhands::ray_cast_all(placed_geoms(now), origin, unit, max_distance);
  for (WorldRayHit& hit : hits) hit = shown(now, hit);
  return hits;
}

std::string World::link_name(LinkId id) const { return loose().model->link(loose().hidden(id)).name; }
std::string World::geom_name(GeomId id) const { return geom_label(*loose().model, loose().hidden(id)); }

}  // namespace manyhands
