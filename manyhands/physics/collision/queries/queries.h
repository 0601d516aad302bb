// Questions about a placed world: how far its links are from each other, and what a ray meets first.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "manyhands/physics/collision/broad/bounds_meet.h"
#include "manyhands/physics/collision/queries/distance.h"
#include "manyhands/physics/dynamics/workspace.h"

namespace manyhands {

/// Where the colliding geoms of one world are; kept while nothing moves.
struct GeomPlaces {
  std::vector<Transform<double>> X_WG;  ///< (colliders)
  std::vector<double> radius;  ///< (colliders) of a ball about the origin that holds it [m]; infinite for planes

  GeomPlaces() = default;
  GeomPlaces(const Colliders<double>& colliders, const Params<double>& params, const Workspace<double>& ws) {
    extend(colliders, params, ws);
  }

  /// Adds those that are not there yet, for the bodies as placed in `ws`, with the sizes in `params`.
  void extend(const Colliders<double>& colliders, const Params<double>& params, const Workspace<double>& ws);
  /// What was removed meets nothing.
  void remove(std::size_t collider) { radius[collider] = -std::numeric_limits<double>::infinity(); }
  void clear();
};

/// The colliding geoms of one world, where they are; what it was made from outlives it.
class PlacedGeoms {
 public:
  PlacedGeoms(const Colliders<double>& colliders, const Params<double>& params, const GeomPlaces& places)
      : colliders_(colliders), params_(params), places_(places) {}

  [[nodiscard]] std::size_t size() const { return places_.X_WG.size(); }
  [[nodiscard]] const Collider<double>& geom(std::size_t i) const { return colliders_.geoms[i]; }
  [[nodiscard]] const Transform<double>& pose(std::size_t i) const { return places_.X_WG[i]; }
  /// Of a ball about the geom's origin that holds it [m]; infinite for planes, and minus that for what was removed.
  [[nodiscard]] double radius(std::size_t i) const { return places_.radius[i]; }
  [[nodiscard]] ShapeView shape(std::size_t i) const;
  /// The indices of a link's geoms.
  [[nodiscard]] std::vector<std::size_t> of_link(const Model& model, LinkId link) const;
  /// Whether the model's rules let the two touch.
  [[nodiscard]] bool may_touch(std::size_t a, std::size_t b) const { return colliders_.pair_of(a, b).has_value(); }

 private:
  const Colliders<double>& colliders_;
  const Params<double>& params_;
  const GeomPlaces& places_;
};

/// The nearest surfaces of two links, or the deepest where they overlap.
struct LinkDistance {
  LinkId link_a{}, link_b{};
  GeomId geom_a{}, geom_b{};
  ShapeDistance<double> surfaces{};  ///< world axes
};

/// Between any two links, whatever the rules of contact; none if one of them has no colliding geom. Margins of geoms
/// are not added.
[[nodiscard]] std::optional<LinkDistance> link_distance(const Model& model, const PlacedGeoms& geoms, LinkId a,
                                                        LinkId b);

/// Every two links that may touch and are less than d [m] apart, sorted by links, link_a < link_b.
[[nodiscard]] std::vector<LinkDistance> links_within(const PlacedGeoms& geoms, double d);
/// The same, but only those with one link: a fraction of the work.
[[nodiscard]] std::vector<LinkDistance> links_within(const Model& model, const PlacedGeoms& geoms, double d,
                                                     LinkId link);

/// What a ray meets first.
struct WorldRayHit {
  LinkId link{};
  GeomId geom{};
  Vec3<double> point{};   ///< [m]
  Vec3<double> normal{};  ///< unit, of the surface, against the ray
  double distance{};      ///< along the ray [m]
};

/// Where a ray enters each geom that it meets, the nearest first; distance 0 where it begins inside. As below.
[[nodiscard]] std::vector<WorldRayHit> ray_cast_all(const PlacedGeoms& geoms, const Vec3<double>& origin,
                                                    const Vec3<double>& direction, double far);

/// Of each ray from origins[i] along the unit vector directions[i], no farther than `far` [m]; all in world axes. The
/// spans are of one length.
[[nodiscard]] std::vector<std::optional<WorldRayHit>> ray_cast(const PlacedGeoms& geoms,
                                                               std::span<const Vec3<double>> origins,
                                                               std::span<const Vec3<double>> directions, double far);

}  // namespace manyhands
