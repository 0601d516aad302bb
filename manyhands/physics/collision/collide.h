// Which geoms touch, or may within a step: bounds, then the narrow phase of each pair whose bounds meet.
#pragma once

#include <span>

#include "manyhands/physics/collision/collide_pair.h"

namespace manyhands {

/// One manifold with a point near enough to matter in some world.
template <Number T>
struct Touch {
  std::size_t pair{};      ///< index in the list of pairs
  std::size_t manifold{};  ///< its place in the contact cache
  Manifold<T> contact{};
};

/// Where geoms are and how far they may come in a step; what touches.
template <Number T>
struct CollisionWorkspace {
  explicit CollisionWorkspace(const Colliders<real_t<T>>& colliders)
      : X_WG(colliders.geoms.size(), Transform<T>::identity()),
        advance(X_WG.size(), Motion<T>::zero()),
        radius(X_WG.size()),
        ahead(X_WG.size()),
        is_oriented(X_WG.size()) {
    touches.reserve(colliders.num_manifolds);
  }

  std::vector<Transform<T>> X_WG;  ///< (colliders) p; R where it is oriented
  std::vector<Motion<T>> advance;  ///< in a step at present velocities, about the geom's origin [rad, m]; the same
  std::vector<T> radius;           ///< of the bounding sphere about the geom's origin [m]
  std::vector<T> ahead;            ///< how far ahead of its surface others are looked for [m]
  std::vector<char> is_oriented;   ///< whether it was asked how the geom is turned
  std::vector<Touch<T>> touches;
  std::array<Manifold<T>, 4> found;  ///< scratch: of one pair
};

namespace internal {

/// Points count that are this far from touching after a step at present velocities, which forces change [m].
inline constexpr double kContactMargin = 0.002;

/// The most by which a body turns and its origin moves in a step at present velocities [rad, m].
template <Number T>
struct Advance {
  T turn, way;
};

template <Number T>
MANYHANDS_INLINE Advance<T> most_advance(const Workspace<T>& ws, std::size_t body, real_t<T> h) {
  const Motion<T>& V = ws.V[body];
  return {T(h) * norm(V.w), T(h) * norm(V.v + cross(V.w, ws.p_OB[body]))};
}

/// Where the geom is, what bounds it, and how far others are looked for.
template <Number T, Number P>
MANYHANDS_INLINE void place_collider(const Collider<real_t<T>>& geom, const Params<P>& params, const Workspace<T>& ws,
                                     const Advance<T>& most, std::size_t g, CollisionWorkspace<T>& cw) {
  const Vec3<T> p_WB = ws.p_OB[geom.body] + ws.p_WO[geom.body];
  cw.X_WG[g].p = ws.R_WB[geom.body] * broadcast<T>(geom.X_BG.p) + p_WB;
  cw.radius[g] = broadcast<T>(bounding_radius(geom, params.geom_size[geom.geom]));
  cw.ahead[g] = T(geom.margin + real_t<T>(kContactMargin / 2));
  if (geom.body == 0) return;  // a plane has no radius
  cw.ahead[g] += fma(most.turn, cw.radius[g] + T(geom.offset), most.way);
}

/// How the geom is turned and moves, unless that is known already.
template <Number T>
MANYHANDS_INLINE void orient_collider(const Collider<real_t<T>>& geom, const Workspace<T>& ws, real_t<T> h,
                                      std::size_t g, CollisionWorkspace<T>& cw) {
  if (cw.is_oriented[g]) return;
  cw.is_oriented[g] = true;
  const Mat3<T>& R_WB = ws.R_WB[geom.body];
  cw.X_WG[g].R = geom.turned ? R_WB * broadcast<T>(geom.X_BG.R) : R_WB;
  if (geom.body == 0) return;
  const Motion<T>& V = ws.V[geom.body];
  const T step(h);
  cw.advance[g] = {step * V.w, step * (V.v + cross(V.w, cw.X_WG[g].p - ws.p_WO[geom.body]))};
}

/// By how much the pair's surfaces come nearer to each other at p along the normal in a step [m]; 0 where they part.
/// The distance of convex shapes that do not turn is a convex function of time: it falls by no more than this.
template <Number T>
MANYHANDS_INLINE T approach(const ColliderPair& pair, const Vec3<T>& p, const Vec3<T>& normal,
                            const CollisionWorkspace<T>& cw) {
  const auto way = [&](std::size_t g) { return cw.advance[g].v + cross(cw.advance[g].w, p - cw.X_WG[g].p); };
  return max(dot(normal, way(pair.a) - way(pair.b)), T(real_t<T>(0)));
}

/// Takes out the points that cannot touch within the step, and the geoms' margins from the distances of the others;
/// where any is left.
template <Number T>
MANYHANDS_INLINE mask_t<T> keep_near_points(const ColliderPair& pair, real_t<T> skin, mask_t<T> near,
                                            const CollisionWorkspace<T>& cw, Manifold<T>& found) {
  const T reach(skin + real_t<T>(kContactMargin)), far(std::numeric_limits<real_t<T>>::infinity());
  mask_t<T> any_left(false);
  for (std::size_t k = 0; k < kManifoldPoints; ++k) {
    const auto left = near & (found.phi[k] < reach + approach(pair, found.p[k], found.normal, cw));
    found.phi[k] = select(left, found.phi[k] - T(skin), far);
    any_left = any_left | left;
  }
  return any_left;
}

}  // namespace internal

/// The geoms of `cw` for the bodies as placed and moving in `ws`; those of the world are oriented.
template <Number T, Number P>
MANYHANDS_INLINE void place_colliders(const Colliders<real_t<T>>& colliders, const Params<P>& params, real_t<T> h,
                                      const Workspace<T>& ws, CollisionWorkspace<T>& cw) {
  std::size_t body = 0;
  internal::Advance<T> most{};
  for (std::size_t g = 0; g < colliders.geoms.size(); ++g) {
    const Collider<real_t<T>>& geom = colliders.geoms[g];
    if (geom.body != body) {
      body = geom.body;
      most = internal::most_advance(ws, body, h);
    }
    internal::place_collider(geom, params, ws, most, g, cw);
    cw.is_oriented[g] = false;
    if (geom.body == 0) internal::orient_collider(geom, ws, h, g, cw);
  }
}

/// Orients all geoms.
template <Number T>
MANYHANDS_INLINE void orient_colliders(const Colliders<real_t<T>>& colliders, real_t<T> h, const Workspace<T>& ws,
                                       CollisionWorkspace<T>& cw) {
  for (std::size_t g = 0; g < colliders.geoms.size(); ++g) internal::orient_collider(colliders.geoms[g], ws, h, g, cw);
}

/// The touches of `cw`, whose geoms are placed, among the pairs.
template <Number T, Number P>
MANYHANDS_INLINE void collide(const Colliders<real_t<T>>& colliders, std::span<const ColliderPair> pairs,
                              const Params<P>& params, real_t<T> h, const Workspace<T>& ws, CollisionWorkspace<T>& cw) {
  using R = real_t<T>;
  cw.touches.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const ColliderPair& pair = pairs[i];
    const T margin = cw.ahead[pair.a] + cw.ahead[pair.b];
    auto near = spheres_meet(colliders, pair, params, margin, cw.X_WG, cw.radius);
    if (none(near)) continue;
    for (const std::size_t g : {pair.a, pair.b}) internal::orient_collider(colliders.geoms[g], ws, h, g, cw);
    near = near & boxes_meet(colliders, pair, params, margin, cw.X_WG, cw.radius);
    if (none(near)) continue;
    const R skin = colliders.geoms[pair.a].margin + colliders.geoms[pair.b].margin;
    const std::size_t count = collide_pair(colliders, pair, params, near, margin, cw.X_WG, cw.found);
    for (std::size_t k = 0; k < count; ++k) {
      if (any(internal::keep_near_points(pair, skin, near, cw, cw.found[k])))
        cw.touches.push_back({i, pair.manifold + k, cw.found[k]});
    }
  }
}

}  // namespace manyhands
