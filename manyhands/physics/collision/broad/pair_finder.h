// The pairs of a large world, found anew in every step.
#pragma once

#include "manyhands/physics/collision/broad/broad_phase.h"
#include "manyhands/physics/collision/collide.h"

namespace manyhands {

/// For one world at a time (T is a real type): the broad phase over its geoms.
template <Real R>
class PairFinder {
 public:
  explicit PairFinder(const Colliders<R>& colliders) : phase_(fixed(colliders)), bounds_(colliders.geoms.size()) {}

  /// The pairs whose bounds, grown by how far they may move, meet; in an order that depends on nothing else.
  template <Number P>
  [[nodiscard]] std::span<const ColliderPair> find(const Colliders<R>& colliders, const Params<P>& params,
                                                   const CollisionWorkspace<R>& cw) {
    for (std::size_t g = 0; g < bounds_.size(); ++g) {
      const Collider<R>& geom = colliders.geoms[g];
      const Aabb<R> box = bounds_of(geom, params.geom_size[geom.geom], cw.radius[g], cw.X_WG[g]);
      const double ahead = cw.ahead[g];
      bounds_[g] = grown(Aabb<double>{broadcast<double>(box.low), broadcast<double>(box.high)}, ahead);
    }
    pairs_.clear();
    for (const NearPair& near : phase_.update(bounds_)) {
      if (std::optional<ColliderPair> pair = colliders.pair_of(near.a, near.b)) {
        pair->manifold = kManifoldPoints * (near.a * bounds_.size() + near.b);
        pairs_.push_back(*pair);
      }
    }
    return pairs_;
  }

 private:
  /// Of a surface, those of the sphere about it.
  static Aabb<R> bounds_of(const Collider<R>& geom, const Vec3<R>& size, R radius, const Transform<R>& X_WG) {
    if (geom.type == ShapeType::kConvex) return world_bounds(geom.type, geom.half, {X_WG.R, X_WG * geom.centre});
    return world_bounds(geom.type, geom.type < ShapeType::kMesh ? size : Vec3<R>{radius, radius, radius}, X_WG);
  }

  static std::vector<bool> fixed(const Colliders<R>& colliders) {
    std::vector<bool> result;
    result.reserve(colliders.geoms.size());
    for (const Collider<R>& geom : colliders.geoms) result.push_back(geom.body == 0);
    return result;
  }

  BroadPhase phase_;
  std::vector<Aabb<double>> bounds_;
  std::vector<ColliderPair> pairs_;
};

}  // namespace manyhands
